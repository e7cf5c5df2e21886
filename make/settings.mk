# When a file is made again. Beside every cloud and image NAME lies NAME.settings, which records what it was made from:
# its own name, by which `make clean` recognizes it; the folder in which make ran; the options, in which files below OUT
# are named without it; and for each input file its path, size, and times of last change. The record is written only
# when it changes, and whatever depends on it is then made again: also from a file of the same name in another folder,
# or from one with an older time stamp. Offers settings and unless_there.

# $(eval $(call settings,NAME,OPTIONS,FILES)) declares NAME.settings. OPTIONS is expanded when the file is written.
define settings
$(1).settings: name = $(patsubst $(OUT)/%,%,$(1))
$(1).settings: options = $(2)
$(1).settings: $(3) .FORCE $(if $(call scenes_of,$(3)),| $(GATHER))
	$$(write_settings)
endef
define write_settings
@[ -d $(@D) ] || mkdir -p $(@D); new=$$(printf '%s\n' $(call quoted,made by make: $(name)) "$$PWD" $(call quoted,$(subst $(OUT)/,,$(options))); \
  $(foreach f,$(filter-out .FORCE,$^),$(call identity,'$(f)'); $(if $(call scenes_of,$(f)),$(call named_by,$(f));))); \
  [ "$$new" = "$$(cat $@ 2>/dev/null)" ] || { printf '%s\n' "$$new" > $@.$$$$ && mv $@.$$$$ $@; }
endef
# The scenes among input files, which are known by their endings.
scenes_of = $(filter-out %.json %.exr %.hdr,$(1))
quoted   = '$(subst ','\'',$(1))'
identity = stat -L -c '%n %s %.9Y %.9Z' $(1)
# The identities of the files that a scene names. A name with a backslash, by which gather prints a character that a
# terminal would obey, counts as changed every time. A scene that cannot be read is left to sample-surface, which says
# why.
define named_by
$(GATHER) --list-files --quiet '$(1)' 2>/dev/null | while IFS= read -r file; do case $$file in *\\*) date +%s.%N; continue; esac; \
    $(call identity,"$$file") 2>/dev/null || printf '%s is not there\n' "$$file"; done
endef

# $(call unless_there,FILE), as a prerequisite, remakes a target whose recipe also makes FILE when FILE is missing.
unless_there = $(if $(wildcard $(1)),,.FORCE)
