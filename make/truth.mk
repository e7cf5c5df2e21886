# What the model is worth on your own scene: `make truth SCENE=path.glb MEDIUM=marble` renders each view twice, as
# `make` does and by random walks in the mesh, which are exact but for their noise, and compares the two on a page.
# The exact images come first: a mesh that is open has none, which gather says at once.
# Offers the target truth, and the variables
#   WIDTH=128   of the pictures, pixels
#   ERROR=0.05  relative standard error of the reference; half of it takes four times as long

.PHONY: truth

WIDTH ?= 128
ERROR ?= 0.05

ifneq ($(and $(SCENE),$(CHECKED)),)
TRUTH_MODEL     := $(OWN_IMAGES)-w$(WIDTH)
TRUTH_REFERENCE := $(OWN)/$(OWN_MEDIUM)-reference-w$(WIDTH)
$(call own_pictures,$(TRUTH_MODEL),--width $(WIDTH),own_model)
$(call own_pictures,$(TRUTH_REFERENCE),--width $(WIDTH),own_reference)
$(eval $(call settings,$(TRUTH_MODEL)))

## truth: your own SCENE=path.glb MEDIUM=marble beside its exact images, as a page (minutes a view; WIDTH=128 ERROR=0.05)
truth: $(OWN_PICTURES:%=$(TRUTH_REFERENCE)/%) $(OWN_PICTURES:%=$(TRUTH_MODEL)/%) $(TRUTH_MODEL).settings | $(COMPARE)
	@{ $(foreach p,$(OWN_PICTURES),$(if $(filter %.views,$(p)),cat $(TRUTH_MODEL)/$(p),echo $(p));) } | { set --; \
	while IFS= read -r image; do \
	  page=$(TRUTH_MODEL)/$${image%.exr}.html; set -- "$$@" "$$page"; \
	  $(COMPARE) "$(TRUTH_REFERENCE)/$$image" "$(TRUTH_MODEL)/$$image" --quiet --html "$$page" || [ $$? = 1 ] || exit 2; \
	done; \
	[ $$# = 1 ] || { $(COMPARE) --html-index $(TRUTH_MODEL).html "$$@" && set -- $(TRUTH_MODEL).html; } || exit 2; \
	echo "The page of the pictures beside the truth is $$1"; }
	@$(say_if_refused)
else
truth:
	@echo 'truth: give SCENE=path.glb' >&2; exit 2
endif
