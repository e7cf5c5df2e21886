# Names of files and values: they become targets and words of commands, so a name that make or the shell would split or
# expand is refused before anything is made. Offers check_name and check_names.

odd      := ' " ` \ $$ ; & | < > ( ) * ? [ ] { } \# % : = ~ ! ^
odd_in    = $(strip $(foreach c,$(odd),$(findstring $(c),$(1))) $(if $(filter 1,$(words x$(1)x)),,a space))
# The goals whose names are checked: removal and help work with any names.
CHECKED  := $(filter-out clean clean-images help,$(or $(MAKECMDGOALS),gallery))
# $(call check_name,VARIABLE,NAME) stops make if NAME is unusable. The message names VARIABLE.
check_name = $(if $(and $(CHECKED),$(call odd_in,$(2))),$(error $(1)=$(2): make cannot work with a name that has \
  $(call odd_in,$(2)) in it; rename it, or give a link to it))
# $(call check_names,VARIABLES) checks the values of variables.
check_names = $(foreach v,$(1),$(call check_name,$(v),$($(v))))

# The environment may have a variable of this name, which is the format of the program `time`.
ifneq ($(filter environment%,$(origin TIME)),)
override TIME :=
endif

$(call check_names,OUT SCENE MEDIUM ENVIRONMENT SIZE TIME BACKDROP SAMPLES SEED MODEL CALIBRATE WALKS WIDTH ERROR)
