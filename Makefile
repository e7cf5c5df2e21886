# The pipeline: scene -> cloud -> images. `make help` lists what there is.
#
# Every recipe is $(SUBMIT) program --threads $(THREADS) ... -o $@: it reads files, writes one, and never asks.

.DELETE_ON_ERROR:
.SECONDARY:
.SUFFIXES:
unexport MAKEFLAGS

# All that is made goes to OUT, where `make clean` removes it: a name of the command line, never one that the environment
# happens to hold.
ifneq ($(filter environment%,$(origin OUT)),)
$(warning OUT=$(OUT) of the environment is not used; give it to make: make OUT=FOLDER)
override OUT := out
endif
OUT     ?= out
$(if $(OUT),,$(error OUT is empty; give a folder, or leave it away for `out`))
THREADS ?= $(shell nproc)
SUBMIT  ?=
CARGO   ?= cargo
SAMPLES ?= 1M
SEED    ?= 0
SPP     ?= 16
MODEL   ?= directional-dipole

# Names become targets and words of commands: one that make or the shell would read as something else is refused.
odd      := ' " ` \ $$ ; & | < > ( ) * ? [ ] { } \# % : = ~ ! ^
odd_in    = $(strip $(foreach c,$(odd),$(findstring $(c),$(1))) $(if $(filter 1,$(words x$(1)x)),,a space))
CHECKED  := $(filter-out clean clean-images help,$(or $(MAKECMDGOALS),gallery))
# $(1) a variable or what the name is of, $(2) the name
check_name = $(if $(and $(CHECKED),$(call odd_in,$(2))),$(error $(1)=$(2): make cannot work with a name that has \
  $(call odd_in,$(2)) in it; rename it, or give a link to it))
check_names = $(foreach v,$(1),$(call check_name,$(v),$($(v))))
$(call check_names,OUT SCENE MEDIUM ENVIRONMENT SAMPLES SEED MODEL)

BIN := target/release
SAMPLE := $(BIN)/sample-surface
GATHER := $(BIN)/gather
MAKE_SCENES := $(BIN)/make-scenes
COMPARE := $(BIN)/compare
CONTACT_SHEET := $(BIN)/contact-sheet
RUN_NAME := k$(SAMPLES)-s$(SEED)

# The gallery: scene:medium, each from every view of the scene in data/views. A scene of several media has its list,
# MATERIAL=medium each, in MEDIA_ and the name that stands for them. What a scene stands under is the same in both
# programs: ENVIRONMENT_<scene>, a picture or R,G,B.
GALLERY := gummies:fruit chess:stones piglet:skin2 candle:candle_wax milk:wholemilk
MEDIA_fruit  := Cherry=cherry Orange=orange Lime=lime
MEDIA_stones := Marble=marble Jade=jade
ENVIRONMENT_gummies := 0.1,0.11,0.13
ENVIRONMENT_chess   := 0.05,0.06,0.08
ENVIRONMENT_piglet  := 0.08,0.09,0.11
ENVIRONMENT_candle  := 0.006,0.008,0.013
ENVIRONMENT_milk    := data/environments/sky.hdr
EXPOSURE_gummies := 0.25
EXPOSURE_chess   := 0.15
EXPOSURE_piglet  := 0.25
EXPOSURE_candle  := 0.7
EXPOSURE_milk    := 0.4

comma := ,
space := $(subst ,, )
media_of       = $(or $(MEDIA_$(1)),$(1))
# Of a list as above: the media, their files, and the options that say them.
names_of       = $(foreach m,$(call media_of,$(1)),$(lastword $(subst =, ,$(m))))
files_of       = $(patsubst %,data/media/%.json,$(call names_of,$(1)))
medium_options = $(foreach m,$(call media_of,$(1)),--medium $(if $(findstring =,$(m)),$(firstword $(subst =, ,$(m)))=)data/media/$(lastword $(subst =, ,$(m))).json)
environment_of = $(if $(ENVIRONMENT_$(1)),--environment $(ENVIRONMENT_$(1)))
pictures_of = $(patsubst data/views/$(1)/%.json,$(OUT)/$(1)/$(RUN_NAME)/$(2)-$(MODEL)/%.exr,$(wildcard data/views/$(1)/*.json))
PICTURES := $(foreach g,$(GALLERY),$(call pictures_of,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g)))))

ifdef SCENE
.DEFAULT_GOAL := own
else
.DEFAULT_GOAL := gallery
endif

# Title=picture, for the contact sheet.
titled = $(foreach p,$(call pictures_of,$(1),$(2)),"$(1) $(basename $(notdir $(p)))/$(subst $(space),$(comma)$(space),$(call names_of,$(2)))=$(basename $(p)).png")

SHEET  = $(foreach g,$(GALLERY),$(call titled,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g)))))

.PHONY: .FORCE gallery own contact-sheet build test check check-images check-alarms check-power golden references browser-test slow farm-test peers fuzz accuracy curve curve-full scale bench lint scenes clouds images help clean clean-images

## gallery: build, and render every scene, medium and view of the gallery (what `make` does)
gallery: contact-sheet
	@echo "All pictures on one sheet: $(OUT)/gallery-$(RUN_NAME).png"
	@echo "Each by itself: $(OUT)/*/$(RUN_NAME)/*/*.png; beside it lies its OpenEXR image."

## images: the gallery's images, with programs that are built
images: $(PICTURES)

## contact-sheet: all pictures of the gallery on one sheet, with their scenes, views and media
contact-sheet: $(OUT)/gallery-$(RUN_NAME).png

$(OUT)/gallery-$(RUN_NAME).png: $(PICTURES) $(OUT)/gallery-$(RUN_NAME).settings | $(CONTACT_SHEET)
	$(CONTACT_SHEET) $(SHEET) -o $@

## clouds: the gallery's clouds
clouds: $(foreach s,$(sort $(foreach g,$(GALLERY),$(word 1,$(subst :, ,$(g))))),$(OUT)/$(s)/$(RUN_NAME).cloud)

## build: the programs, optimised
build:
	$(CARGO) build --release --workspace --quiet

# Beside every cloud and picture NAME lies NAME.settings, which says what it is made from: its own name, by which `make
# clean` knows that it was made here; the folder make ran in; options; of each file its path, its size, and when its
# content and it itself changed last. It is written only when that changes, and what depends on it is then made again:
# also from a file of the same name in another folder, or from one that is older than the last.
# $(1) NAME, $(2) options, expanded when it is written, $(3) files.
define settings
$(1).settings: name = $(patsubst $(OUT)/%,%,$(1))
$(1).settings: options = $(2)
$(1).settings: $(3) .FORCE
	$$(write_settings)
endef
define write_settings
@[ -d $(@D) ] || mkdir -p $(@D); new=$$(printf '%s\n' $(call quoted,made by make: $(name)) "$$PWD" $(call quoted,$(options)); \
  $(foreach f,$(filter-out .FORCE,$^),$(call identity,'$(f)'); $(if $(filter %.json %.exr %.hdr,$(f)),,$(call named_by,$(f));))); \
  [ "$$new" = "$$(cat $@ 2>/dev/null)" ] || { printf '%s\n' "$$new" > $@.$$$$ && mv $@.$$$$ $@; }
endef
quoted   = '$(subst ','\'',$(1))'
identity = stat -L -c '%n %s %.9Y %.9Z' $(1)
# The same of the files that a .gltf or .glb names: of each "uri" of its JSON that is neither data nor elsewhere. A name
# with an escape of JSON, which is not read here, counts as changed every time.
define named_by
{ if [ "$$(head -c 4 '$(1)')" = glTF ]; then head -c $$(($$(od -An -tu4 -j 12 -N 4 '$(1)') + 20)) '$(1)'; else cat '$(1)'; fi; } | \
  tr '\t\n\r' '   ' | LC_ALL=C grep -ao '"uri" *: *"[^"]*"' | \
  LC_ALL=C sed -e 's/^"uri" *: *"//' -e 's/"$$//' -e '/^data:/d' -e 's,\\/,/,g' -e '/:\/\//d' | LC_ALL=C sort -u | \
  while IFS= read -r uri; do case $$uri in *\\*) date +%s.%N; continue; esac; \
    file=$$(env printf %b "$$(printf %s "$$uri" | LC_ALL=C sed 's/%\([0-9A-Fa-f]\{2\}\)/\\x\1/g')"); \
    $(call identity,"$(dir $(1))$$file") 2>/dev/null || printf '%s is not there\n' "$$file"; done
endef
# Makes what depends on it again if a file is not there that is made with it.
unless_there = $(if $(wildcard $(1)),,.FORCE)

$(eval $(call settings,$(OUT)/gallery-$(RUN_NAME),$$(SHEET)))

ifeq ($(and $(SCENE),$(CHECKED)),)
# A cloud depends on its scene, its environment and the format's version; programs are order-only, so a rebuild keeps
# clouds. What else changes a cloud (samples, seed) is in its name.
define cloud
$(call settings,$(OUT)/$(1)/$(RUN_NAME),$$(ENVIRONMENT_$(1)),data/scenes/$(1).glb $(wildcard $(ENVIRONMENT_$(1))))
$(OUT)/$(1)/$(RUN_NAME).cloud: data/scenes/$(1).glb $(OUT)/$(1)/$(RUN_NAME).settings crates/formats/cloud-version | $(SAMPLE)
	$$(SUBMIT) $$(SAMPLE) --threads $$(THREADS) --seed $$(SEED) --samples $$(SAMPLES) $(call environment_of,$(1)) --quiet $$< -o $$@
endef
SCENES := $(patsubst data/scenes/%.glb,%,$(wildcard data/scenes/*.glb))
$(foreach s,$(SCENES),$(eval $(call cloud,$(s))))

# $(1) scene, $(2) medium, $(3) view, $(4) picture without its ending
define picture
$(call settings,$(4),--spp $$(SPP) --exposure $$(EXPOSURE_$(1)) $(call medium_options,$(2)),$(call files_of,$(2)) data/views/$(1)/$(3).json)
$(4).exr: $(OUT)/$(1)/$(RUN_NAME).cloud $(OUT)/$(1)/$(RUN_NAME).settings $(4).settings $(call unless_there,$(4).png) | $(GATHER)
	$$(SUBMIT) $$(GATHER) --threads $$(THREADS) --seed $$(SEED) --spp $$(SPP) --bssrdf $$(MODEL) $(call medium_options,$(2)) \
	  $(call environment_of,$(1)) --view data/views/$(1)/$(3).json --preview $$(basename $$@).png \
	  --exposure $$(or $$(EXPOSURE_$(1)),0) --quiet $$< data/scenes/$(1).glb -o $$@
endef
$(foreach g,$(GALLERY),$(foreach p,$(call pictures_of,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g)))),\
$(eval $(call picture,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g))),$(notdir $(basename $(p))),$(basename $(p))))))

else
# A user's own file: make SCENE=path.glb MEDIUM=marble [SAMPLES=4M], one image for each of its cameras, or for each of
# VIEWS='path/*.json'; with an empty MEDIUM= the file's own media; ENVIRONMENT=sky.exr or R,G,B lights it from all around.
MEDIUM ?= marble
OWN := $(OUT)/$(notdir $(basename $(SCENE)))/$(RUN_NAME)
OWN_IMAGES := $(OWN)/$(or $(notdir $(basename $(MEDIUM))),own)-$(MODEL)
$(eval $(call settings,$(OWN),$$(strip $$(ENVIRONMENT) $$(TRANSLUCENT)),$(SCENE) $(wildcard $(ENVIRONMENT))))

ifdef VIEWS
VIEW_FILES := $(foreach v,$(VIEWS),$(or $(wildcard $(v)),$(error no view at $(v))))
VIEW_NAMES := $(basename $(notdir $(VIEW_FILES)))
$(foreach v,$(VIEW_FILES),$(call check_name,VIEWS,$(v)))
$(if $(filter-out %.json,$(VIEW_FILES)),$(error VIEWS: not a .json file: $(filter-out %.json,$(VIEW_FILES))))
$(if $(filter-out $(words $(sort $(VIEW_NAMES))),$(words $(VIEW_NAMES))),$(error VIEWS: two files of one name: $(VIEW_FILES)))
# Of a list of views NAME.json the images are NAME.VIEW.exr, and NAME.views is written when all are there: their names.
LISTS := $(shell awk 'FNR == 1 { text = "" } length(text) < 9 { text = text $$0; gsub(/[ \t\r]/, "", text); \
  if (text ~ /^(\[|{"views":)/ && !(FILENAME in seen)) { seen[FILENAME]; print FILENAME } }' $(VIEWS))
$(foreach l,$(basename $(notdir $(LISTS))),$(if $(filter $(l).%,$(VIEW_NAMES)),$(error VIEWS: an image of the list $(l).json could \
  have the name of that of $(firstword $(filter $(l).%,$(VIEW_NAMES))).json; rename one of them)))
picture_of = $(OWN_IMAGES)/$(notdir $(basename $(1))).$(if $(filter $(1),$(LISTS)),views,exr)
OWN_PICTURES := $(foreach v,$(VIEW_FILES),$(call picture_of,$(v)))
else
# Made, and then read again by make itself: the cameras are those of the file.
include $(OWN).cameras
OWN_PICTURES := $(CAMERAS:%=$(OWN_IMAGES)/camera%.exr)
endif

own: $(OWN_PICTURES)
	@echo "The pictures are in $(OWN_IMAGES)/: one .png and one OpenEXR image for each view."

$(OWN).cameras: $(SCENE) $(OWN).settings | $(GATHER)
	@$(GATHER) --list-cameras --quiet '$<' > $@.list
	@sed -e 1d -e 's/ .*//' -e 's/^/CAMERAS += /' $@.list > $@
	@rm $@.list
	@test -s $@ || { echo "$<: it has no camera; give VIEWS='path/*.json'" >&2; exit 2; }

$(OWN).cloud: $(SCENE) $(OWN).settings crates/formats/cloud-version | $(SAMPLE)
	$(SUBMIT) $(SAMPLE) --threads $(THREADS) --seed $(SEED) --samples $(SAMPLES) $(foreach t,$(TRANSLUCENT),--translucent $(call quoted,$(t))) \
	  $(if $(ENVIRONMENT),--environment $(ENVIRONMENT)) '$<' -o $@

# Of a list: its images with their numbers in the file system, which are new of those that were written.
images_of_list = cd $(@D) && stat -c '%i %n' $(basename $(@F)).*.exr 2>/dev/null
lost_of_list = $(shell cd $(dir $(1)) 2>/dev/null && while IFS= read -r image; do [ -e "$$image" ] && [ -e "$${image%.exr}.png" ] || \
  echo .FORCE; done 2>/dev/null < $(notdir $(1)))
define list_before
@$(images_of_list) > $(@F).before || true
endef
define list_after
@made=$$($(images_of_list) | grep -vxFf $(@F).before | sed 's/^[0-9]* //'); printf '%s\n' "$$made" > $@ && rm $@.before
endef

# $(1) image, or what says that all images of a list are there; $(2) the file of its view if it has one, $(3) option that
# says the view. A medium may be one of the built-in ones, which are those of data/media.
define own_picture
$(call settings,$(basename $(1)),--spp $$(SPP) --exposure $$(EXPOSURE) --medium $$(MEDIUM) $(3),$(wildcard $(MEDIUM) data/media/$(MEDIUM).json) $(2))
$(1): $(OWN).cloud $(OWN).settings $(basename $(1)).settings $(if $(filter %.views,$(1)),$(call lost_of_list,$(1)),$(call \
  unless_there,$(basename $(1)).png)) | $(GATHER)
	$(if $(filter %.views,$(1)),$$(list_before))
	$$(SUBMIT) $(GATHER) --threads $$(THREADS) --seed $$(SEED) --spp $$(SPP) --bssrdf $$(MODEL) $$(if $$(MEDIUM),--medium $$(MEDIUM)) $(3) \
	  $$(if $$(ENVIRONMENT),--environment $$(ENVIRONMENT)) --preview $$(basename $$@).png --exposure $$(or $$(EXPOSURE),0) $$< '$$(SCENE)' -o $$(basename $$@).exr
	$(if $(filter %.views,$(1)),$$(list_after))
endef
$(foreach c,$(CAMERAS),$(eval $(call own_picture,$(OWN_IMAGES)/camera$(c).exr,,--camera index:$(c))))
$(foreach v,$(VIEW_FILES),$(eval $(call own_picture,$(call picture_of,$(v)),$(v),--view $(v))))
endif

$(SAMPLE) $(GATHER) $(COMPARE) $(MAKE_SCENES) $(CONTACT_SHEET): | build ;

## scenes: write data/scenes, data/views and data/environments again
scenes: build
	$(MAKE_SCENES) data

## test: all fast tests
test:
	$(CARGO) test --workspace --quiet

## browser-test: the pages of `compare --html` in headless Chromium (needs chromium and python3; half a minute)
browser-test:
	@command -v python3 >/dev/null || { echo "browser-test: no python3 found; install it (Debian: apt install python3)" >&2; exit 1; }
	$(CARGO) build --release --package compare --quiet
	python3 -B tests/browser/run.py $(BIN)/compare

# The noise test (docs/check.md): small images of each scene of the gallery, each from a cloud with a seed of its own.
# Settings and seeds are part of the folder's name. CHECK_SEED is the first of CHECK_COUNT seeds.
CHECK_SEED  ?= 1000
CHECK_COUNT ?= 8
CHECK_SAMPLES := 100k
CHECK_SPP     := 12
CHECK_SIZE    := 48
# Light from a flame inside a hollow takes many samples before its means are near normal.
CHECK_SAMPLES_candle := 500k
# The one medium that absorbs in all colors, and thus tells most about coefficients, is worth more.
CHECK_SAMPLES_piglet := 200k
CHECK_SPP_piglet     := 24
REFERENCE_SEED  := 1
REFERENCE_COUNT := 64
GOLDEN := tests/golden

$(call check_names,GOLDEN CHECK_SEED CHECK_COUNT CHECK_SIZE)
$(if $(GOLDEN),,$(error GOLDEN is empty; leave it away for tests/golden))
CHECK_SEEDS  := $(shell seq $(CHECK_SEED) $$(($(CHECK_SEED) + $(CHECK_COUNT) - 1)))
CHECK_SCENES := $(foreach g,$(GALLERY),$(firstword $(subst :, ,$(g))))
# $(1) scene
check_setting = $(or $(CHECK_$(2)_$(1)),$(CHECK_$(2)))
check_view    = $(firstword $(sort $(wildcard data/views/$(1)/*.json)))
check_folder  = $(OUT)/check/s$(CHECK_SEED)-n$(CHECK_COUNT)/$(1)-k$(call check_setting,$(1),SAMPLES)-p$(call check_setting,$(1),SPP)-w$(CHECK_SIZE)
# What is stored with the golden figures: $(1) scene, $(2) medium.
check_sample  = --samples $(call check_setting,$(1),SAMPLES) $(call environment_of,$(1))
check_gather  = --spp $(call check_setting,$(1),SPP) --width $(CHECK_SIZE) --height $(CHECK_SIZE) --bssrdf directional-dipole \
  $(call medium_options,$(2)) $(call environment_of,$(1)) --view $(call check_view,$(1))

# Here the programs are what is tested, so all is made again when they change; sample-surface would keep a cloud that is
# there.
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

# The figures, the mean image, and the commands that made them; never from the few images of `make check`.
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

## slow: statistical and stability tests at full sample counts
slow: build
	$(CARGO) test --release --package bssrdf --test lanes -- --nocapture
	$(CARGO) test --release --package pipeline-tests --features slow
	$(CARGO) test --release --package sample-surface --features slow --test targets -- --nocapture
	$(CARGO) test --release --package gather --features slow --test programs -- --nocapture mutations faults sixteen

# Outside the workspace, with a nightly compiler. What is new goes to OUT, not into the corpus.
# TARGET of the environment is mostly a compiler's.
TARGET  := cloud
TARGETS := $(basename $(notdir $(wildcard fuzz/targets/*.rs)))
SECONDS ?= 3600
$(call check_names,TARGET)

## fuzz: look for bytes that break TARGET=cloud, facts, gltf, image, limits, medium or view, for SECONDS=3600 (fuzz/README.md)
fuzz:
	$(if $(filter $(TARGET),$(TARGETS)),,$(error TARGET=$(TARGET): it is one of $(TARGETS)))
	@mkdir -p $(OUT)/fuzz/$(TARGET)/found
	$(CARGO) +nightly fuzz run --fuzz-dir fuzz $(TARGET) $(OUT)/fuzz/$(TARGET)/found fuzz/corpus/$(TARGET) -- \
	  -artifact_prefix=$(abspath $(OUT))/fuzz/$(TARGET)/ -max_total_time=$(SECONDS) \
	  -rss_limit_mb=2048 -timeout=10 -max_len=65536 -print_final_stats=1

## peers: the metrics of `compare` against scikit-image and flip-evaluator (Python 3.11 or later, and a network once)
peers: build
	python3 tests/peers/metrics.py --compare $(BIN)/compare --environment target/peers-venv

## farm-test: twelve views through a Slurm farm of two nodes on this machine (root; a minute)
farm-test:
	tests/farm/run

# Each writes docs/reports.
REPORTS := $(CARGO) run --release --quiet --package reports -- --output docs/reports

## accuracy: what the models are worth, against random walks: docs/reports/accuracy.md and its pictures (minutes)
accuracy:
	$(REPORTS) accuracy

# Where `make curve` finds bunny.glb and dragon.glb, and peers/ in the folder above; without them it takes a scene of data/.
MESHES ?= data/scenes
CURVE  := $(REPORTS) speed --meshes $(MESHES) --programs $(BIN)

## curve: time against error: docs/reports/speed.md with its plots and raw data (minutes; MESHES=folder of bunny.glb, dragon.glb)
curve: build
	$(CURVE)

## curve-full: the same with larger clouds and more runs (an hour)
curve-full: build
	$(CURVE) --full

## scale: what sizes cost, and what that says of farms: docs/reports/scale.md (minutes)
scale: build
	$(REPORTS) scale --programs $(BIN)

## bench: the kernels, the trees and the rays by themselves
bench:
	$(CARGO) bench --package bssrdf --bench kernels
	$(CARGO) bench --package scene --bench rays

## lint: formatting, and clippy without warnings
lint:
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets --quiet -- -D warnings

# Removes, by the settings in OUT that begin with their own names, what was made with them; then folders that are empty.
# Nothing else in OUT was made here, whatever it is called, and no link in it is followed. $(1) images or all
define remove
@out=$(call quoted,$(OUT)); case $$out in /*) ;; *) out=./$$out; esac; [ -d "$$out" ] || exit 0; \
(cd "$$out" && find . -maxdepth 4 -type f -name '*.settings' -exec sh -c ' \
  for file; do \
    name=$${file#./} name=$${name%.settings}; \
    [ "$$(head -n 1 "$$file")" = "made by make: $$name" ] || continue; \
    case $$name in */*) folder=$${name%/*} ;; *) folder=. ;; esac; \
    rm -f "$$name.exr" "$$name.png"; \
    [ ! -f "$$name.views" ] || while IFS= read -r image; do \
      case $$image in */*) ;; *.exr) rm -f "$$folder/$$image" "$$folder/$${image%.exr}.png"; esac; done < "$$name.views"; \
    case $$name in check/*/image) rm -f "$$folder"/[0-9]*.exr; esac; \
    if [ $(1) = all ]; then \
      case $$name in check/*/cloud) rm -f "$$folder"/[0-9]*.cloud "$$folder.json"; esac; \
      rm -f "$$folder/.$${name##*/}".*.tmp "$$name.cloud" "$$name.views" "$$name.views.before" "$$name.cameras" "$$name.cameras.list" "$$file"; \
    fi; \
    while [ "$$folder" != . ] && rmdir "$$folder" 2>/dev/null; do \
      case $$folder in */*) folder=$${folder%/*} ;; *) folder=. ;; esac; done; \
  done' sh {} +); \
rmdir "$$out" 2>/dev/null || [ -z "$$(ls -A "$$out")" ] || [ $(1) = images ] || \
  printf '%s\n' $(call quoted,$(OUT) stays: it holds what this Makefile did not make)
endef

## clean-images: remove images, keep clouds
clean-images:
	$(call remove,images)

## clean: remove all that was rendered, and nothing else
clean:
	$(call remove,all)

## help: this list
help:
	@sed -n 's/^## /  make /p' $(MAKEFILE_LIST)
	@echo "  make SCENE=path.glb MEDIUM=marble [SAMPLES=4M] [TRANSLUCENT=Wax] [EXPOSURE=1]: your own file, one image a camera"
	@echo "  make SCENE=path.glb MEDIUM=marble VIEWS='views/*.json': the same, one image a view file"
	@echo "  variables: OUT=$(OUT) THREADS=$(THREADS) SUBMIT=$(SUBMIT) SAMPLES=$(SAMPLES) SEED=$(SEED) SPP=$(SPP) MODEL=$(MODEL)"
