# The gallery: the scenes of data/, each with a medium and from every view of the scene in data/views. Offers the
# targets gallery, images, contact-sheet and clouds, and to check.mk the media, files and light of each scene.

# scene:medium. A scene with several media has a list of MATERIAL=medium in MEDIA_<name>, and <name> stands for the
# list. ENVIRONMENT_<scene> is the light from all around, in both programs: a picture or R,G,B. EXPOSURE_<scene> is added
# to the preview's own exposure.
GALLERY := peach:stone_fruit gummies:fruit chess:stones piglet:skin2 candle:candle_wax milk:wholemilk
MEDIA_stone_fruit := Peach=peach Slice=peach_flesh
MEDIA_fruit  := Cherry=cherry Orange=orange Lime=lime
MEDIA_stones := Marble=marble Jade=jade
ENVIRONMENT_peach   := data/environments/studio.hdr
ENVIRONMENT_gummies := 0.1,0.11,0.13
ENVIRONMENT_chess   := 0.05,0.06,0.08
ENVIRONMENT_piglet  := 0.08,0.09,0.11
ENVIRONMENT_candle  := 0.006,0.008,0.013
ENVIRONMENT_milk    := data/environments/sky.hdr
EXPOSURE_peach   := 0.2
EXPOSURE_gummies := 0.4
EXPOSURE_chess   := -0.2
EXPOSURE_piglet  := 0.4
EXPOSURE_candle  := 0.3

# Paths per pixel of scenes whose rough surfaces mirror others, unless SPP is given. The gallery takes seven minutes on two
# cores.
PATHS_peach := 32
PATHS_chess := 24
paths_of     = $(if $(filter file,$(origin SPP)),$(or $(PATHS_$(1)),$(SPP)),$(SPP))

comma := ,
space := $(subst ,, )
media_of       = $(or $(MEDIA_$(1)),$(1))
# Of a medium or a list of media: the names of the media, their files, and the options of gather that choose them.
names_of       = $(foreach m,$(call media_of,$(1)),$(lastword $(subst =, ,$(m))))
files_of       = $(patsubst %,data/media/%.json,$(call names_of,$(1)))
medium_options = $(foreach m,$(call media_of,$(1)),--medium $(if $(findstring =,$(m)),$(firstword $(subst =, ,$(m)))=)data/media/$(lastword $(subst =, ,$(m))).json)
# The calibration that all pictures of a scene and medium share, if they have one, and the media of a picture.
calibration_of = $(if $(CALIBRATED),$(OUT)/$(1)/$(RUN_NAME)/$(2)-$(MODEL).calibration)
calibrated     = $(if $(CALIBRATED),--calibration $(call calibration_of,$(1),$(2)),--calibration none $(call medium_options,$(2)))
environment_of = $(if $(ENVIRONMENT_$(1)),--environment $(ENVIRONMENT_$(1)))
pictures_of = $(patsubst data/views/$(1)/%.json,$(OUT)/$(1)/$(RUN_NAME)/$(2)-$(MODEL)/%.exr,$(wildcard data/views/$(1)/*.json))
PICTURES := $(foreach g,$(GALLERY),$(call pictures_of,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g)))))

# TITLE=PICTURE for each picture of a scene with a medium, as the contact sheet wants it.
titled = $(foreach p,$(call pictures_of,$(1),$(2)),"$(1) $(basename $(notdir $(p)))/$(subst $(space),$(comma)$(space),$(call names_of,$(2)))=$(basename $(p)).png")

SHEET  = $(foreach g,$(GALLERY),$(call titled,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g)))))

.PHONY: gallery images contact-sheet clouds

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

$(eval $(call settings,$(OUT)/gallery-$(RUN_NAME),$$(SHEET)))

# These rules are left out for a scene of your own, whose files may have the same names.
ifeq ($(and $(SCENE),$(CHECKED)),)
# $(1) scene. A cloud depends on its scene, its environment and the version of the format. Samples and seed are in its
# name. Programs are order-only prerequisites, so that clouds outlast a rebuild.
define cloud
$(call settings,$(OUT)/$(1)/$(RUN_NAME),$$(ENVIRONMENT_$(1)),data/scenes/$(1).glb $(wildcard $(ENVIRONMENT_$(1))))
$(OUT)/$(1)/$(RUN_NAME).cloud: data/scenes/$(1).glb $(OUT)/$(1)/$(RUN_NAME).settings crates/formats/cloud-version | $(SAMPLE)
	$$(SUBMIT) $$(SAMPLE) --threads $$(THREADS) --seed $$(SEED) --samples $$(SAMPLES) $(call environment_of,$(1)) --quiet $$< -o $$@
endef
SCENES := $(patsubst data/scenes/%.glb,%,$(wildcard data/scenes/*.glb))
$(foreach s,$(SCENES),$(eval $(call cloud,$(s))))

# $(1) scene, $(2) medium. A calibration depends on its cloud, its media and the version of the format.
define calibration
$(call settings,$(OUT)/$(1)/$(RUN_NAME)/$(2)-$(MODEL),--walks $$(WALKS) $(call medium_options,$(2)),$(call files_of,$(2)))
$(call calibration_of,$(1),$(2)): $(OUT)/$(1)/$(RUN_NAME).cloud $(OUT)/$(1)/$(RUN_NAME).settings \
  $(OUT)/$(1)/$(RUN_NAME)/$(2)-$(MODEL).settings crates/formats/calibration-version | $(CALIBRATOR)
	$$(SUBMIT) $$(CALIBRATOR) --threads $$(THREADS) --seed $$(SEED) --walks $$(WALKS) --bssrdf $$(MODEL) $(call medium_options,$(2)) \
	  $(call environment_of,$(1)) --quiet $$< data/scenes/$(1).glb -o $$@
endef
$(if $(CALIBRATED),$(foreach g,$(GALLERY),$(eval $(call calibration,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g)))))))

# $(1) scene, $(2) medium, $(3) view, $(4) image without its ending.
define picture
$(call settings,$(4),--spp $(call paths_of,$(1)) --exposure $$(EXPOSURE_$(1)) $(call calibrated,$(1),$(2)),$(call files_of,$(2)) data/views/$(1)/$(3).json)
$(4).exr: $(OUT)/$(1)/$(RUN_NAME).cloud $(OUT)/$(1)/$(RUN_NAME).settings $(call calibration_of,$(1),$(2)) $(4).settings \
  $(call unless_there,$(4).png) | $(GATHER)
	$$(SUBMIT) $$(GATHER) --threads $$(THREADS) --seed $$(SEED) --spp $(call paths_of,$(1)) --bssrdf $$(MODEL) $(call calibrated,$(1),$(2)) \
	  $(call environment_of,$(1)) --view data/views/$(1)/$(3).json --preview $$(basename $$@).png \
	  --exposure $$(or $$(EXPOSURE_$(1)),0) --quiet $$< data/scenes/$(1).glb -o $$@
endef
$(foreach g,$(GALLERY),$(foreach p,$(call pictures_of,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g)))),\
$(eval $(call picture,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g))),$(notdir $(basename $(p))),$(basename $(p))))))
endif
