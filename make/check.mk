# The regression test (docs/check.md): small images of each scene of the gallery, each from a cloud with a seed of its
# own, are tested against the figures of tests/golden. Offers check, check-images, references, check-alarms and
# check-power.

.PHONY: check check-images check-alarms check-power references golden

# Settings and seeds are part of the folder's name. The seeds are the CHECK_COUNT ones from CHECK_SEED on.
CHECK_SEED  ?= 1000
CHECK_COUNT ?= 8
CHECK_SAMPLES := 100k
CHECK_SPP     := 12
CHECK_SIZE    := 48
# The candle's means are near a normal distribution only with many samples: few of them see the flame in its hollow.
CHECK_SAMPLES_candle := 500k
# Skin, the only medium here that absorbs in all channels, is the most sensitive to coefficients, and gets more of both.
CHECK_SAMPLES_piglet := 200k
CHECK_SPP_piglet     := 24
REFERENCE_SEED  := 1
REFERENCE_COUNT := 64
GOLDEN := tests/golden

$(call check_names,GOLDEN CHECK_SEED CHECK_COUNT CHECK_SIZE)
$(if $(GOLDEN),,$(error GOLDEN is empty; leave it away for tests/golden))
CHECK_SEEDS  := $(shell seq $(CHECK_SEED) $$(($(CHECK_SEED) + $(CHECK_COUNT) - 1)))
CHECK_SCENES := $(foreach g,$(GALLERY),$(firstword $(subst :, ,$(g))))
# $(1) scene, $(2) SAMPLES or SPP.
check_setting = $(or $(CHECK_$(2)_$(1)),$(CHECK_$(2)))
check_view    = $(firstword $(sort $(wildcard data/views/$(1)/*.json)))
check_folder  = $(OUT)/check/s$(CHECK_SEED)-n$(CHECK_COUNT)/$(1)-k$(call check_setting,$(1),SAMPLES)-p$(call check_setting,$(1),SPP)-w$(CHECK_SIZE)
# The options of both programs, which are stored with the golden figures: $(1) scene, $(2) medium.
check_sample  = --samples $(call check_setting,$(1),SAMPLES) $(call environment_of,$(1))
check_gather  = --spp $(call check_setting,$(1),SPP) --width $(CHECK_SIZE) --height $(CHECK_SIZE) --bssrdf directional-dipole \
  $(call medium_options,$(2)) $(call environment_of,$(1)) --view $(call check_view,$(1))

# The programs are what is tested, so everything is made again when they change. The old cloud is removed first, because
# sample-surface keeps a cloud that is up to date.
define check_rules
$(call settings,$(call check_folder,$(1))/cloud,$(call check_sample,$(1)),data/scenes/$(1).glb $(wildcard $(ENVIRONMENT_$(1))))
$(call settings,$(call check_folder,$(1))/image,$(call check_gather,$(1),$(2)),$(call files_of,$(2)) $(call check_view,$(1)))
$(call check_folder,$(1))/%.cloud: data/scenes/$(1).glb $(call check_folder,$(1))/cloud.settings crates/formats/cloud-version $(SAMPLE)
	@mkdir -p $$(@D) && rm -f $$@
	$$(SUBMIT) $$(SAMPLE) --threads $$(THREADS) --seed $$* $(call check_sample,$(1)) --quiet $$< -o $$@
$(call check_folder,$(1))/%.exr: $(call check_folder,$(1))/%.cloud $(call check_folder,$(1))/image.settings $(GATHER)
	@mkdir -p $$(@D)
	$$(SUBMIT) $$(GATHER) --threads $$(THREADS) --seed $$* $(call check_gather,$(1),$(2)) --quiet $$< data/scenes/$(1).glb -o $$@
CHECK_IMAGES += $(foreach s,$(CHECK_SEEDS),$(call check_folder,$(1))/$(s).exr)
endef
$(foreach g,$(GALLERY),$(eval $(call check_rules,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g))))))

## check: small images with new clouds against tests/golden, by statistics (docs/check.md; CHECK_SEED=N for other seeds)
check: build
	@$(MAKE) --no-print-directory --silent check-images OUT='$(OUT)'
	@code=0; for scene in $(foreach s,$(CHECK_SCENES),$(s)=$(call check_folder,$(s))); do \
	  $(COMPARE) --replicates --family $(words $(CHECK_SCENES)) --quiet --json "$${scene#*=}.json" $(GOLDEN)/"$${scene%%=*}" "$${scene#*=}" || code=1; \
	done; exit $$code

## check-images: the images that `make check` judges
check-images: $(CHECK_IMAGES)

## references: tests/golden again, from other seeds than those of `make check`; see docs/check.md for when
references: build
	@$(MAKE) --no-print-directory --silent check-images OUT='$(OUT)' CHECK_SEED=$(REFERENCE_SEED) CHECK_COUNT=$(REFERENCE_COUNT)
	@$(MAKE) --no-print-directory golden OUT='$(OUT)' GOLDEN='$(GOLDEN)' CHECK_SEED=$(REFERENCE_SEED) CHECK_COUNT=$(REFERENCE_COUNT) \
	  REFERENCE_SEED=$(REFERENCE_SEED) REFERENCE_COUNT=$(REFERENCE_COUNT)

golden: $(foreach s,$(CHECK_SCENES),golden-$(s))

# The figures of one scene, the mean image, and the commands that made them. The few images of `make check` are refused.
define golden
golden-$(1):
	@test '$(CHECK_SEED) $(CHECK_COUNT)' = '$(REFERENCE_SEED) $(REFERENCE_COUNT)' || { echo '$$@: use make references' >&2; exit 2; }
	$(COMPARE) --summarise $(call check_folder,$(1)) $(GOLDEN)/$(1)
	@printf '%s\n' 'for s in $$$$(seq $(firstword $(CHECK_SEEDS)) $(lastword $(CHECK_SEEDS))); do' \
	  '  sample-surface --seed $$$$s $(call check_sample,$(1)) data/scenes/$(1).glb -o $$$$s.cloud' \
	  '  gather --seed $$$$s $(strip $(call check_gather,$(1),$(2))) $$$$s.cloud data/scenes/$(1).glb -o $(1)/$$$$s.exr' \
	  'done' 'compare --summarise $(1) $(GOLDEN)/$(1)' > $(GOLDEN)/$(1)/command.sh
endef
$(foreach g,$(GALLERY),$(eval $(call golden,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g))))))

## check-alarms: `make check` under RUNS=200 new seeds, none of which may fail (an hour)
RUNS ?= 200
check-alarms: build
	OUT='$(OUT)' tests/check/alarms.sh $(RUNS)

## check-power: errors planted one by one into a copy of the tree, each of which `make check` must find (many minutes)
check-power:
	tests/check/planted.sh
