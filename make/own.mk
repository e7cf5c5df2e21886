# Your own scene: `make SCENE=path.glb MEDIUM=marble` renders one image for each camera of the file or, if it has none, one
# from the front and one against the light. Offers the target own, and the variables
#   VIEWS='path/*.json'       one image for each of these view files, or several for one that holds a list of views
#   MEDIUM=name|file.json     the medium of all translucent surfaces: marble, unless the file gives all of them media, of which
#                             one scatters; with an empty MEDIUM= the file's own media
#   ENVIRONMENT=studio|sky|sky.exr|R,G,B  light from all around; a scene without any light has the studio
#   SIZE=0.1                  the largest extent of the translucent surfaces, m
#   TIME=0.5 ANIMATION='walk' the pose of a scene with animations, s; at rest without both
#   BACKDROP=yes              the camera sees a plain dark gray instead of the light from all around
#   TRANSLUCENT='Wax Skin'    the translucent materials, by name
#   EXPOSURE=1                stops by which the previews are brightened beyond their own exposure
# and to truth.mk the rules of its pictures.

.PHONY: own

ifneq ($(and $(SCENE),$(CHECKED)),)
OWN := $(OUT)/$(notdir $(basename $(SCENE)))/$(RUN_NAME)
own_scene   = $(if $(ENVIRONMENT),--environment $(ENVIRONMENT)) $(if $(SIZE),--size $(SIZE)) $(if $(TIME),--time $(TIME)) $(if \
  $(ANIMATION),--animation $(call quoted,$(ANIMATION)))
$(eval $(call settings,$(OWN),$$(strip $$(own_scene) $$(TRANSLUCENT)),$(SCENE) $(wildcard $(ENVIRONMENT))))
# Without MEDIUM, the media of a file are taken that gives all translucent surfaces media of which one scatters.
ifeq ($(origin MEDIUM)$(if $(filter all own truth,$(or $(MAKECMDGOALS),all)),,: not a picture),undefined)
include $(OWN).media
$(OWN).media: $(SCENE) $(OWN).settings | $(GATHER)
	@if $(GATHER) --list-materials --quiet '$<' 2>/dev/null | grep -q "^media: the file's own"; then echo 'MEDIUM ?='; fi > $@
endif
MEDIUM ?= marble
OWN_MEDIUM := $(or $(notdir $(basename $(MEDIUM))),own)
OWN_IMAGES := $(OWN)/$(OWN_MEDIUM)-$(MODEL)
# A medium may be one of the built-in media, which are those of data/media.
OWN_MEDIA  := $(wildcard $(MEDIUM) data/media/$(MEDIUM).json)
own_seen    = $(if $(filter yes,$(BACKDROP)),--backdrop)

MADE_CAMERAS := front backlit
camera_of   = $(if $(filter $(MADE_CAMERAS),$(1)),$(1),camera$(1))

ifdef VIEWS
VIEW_FILES := $(foreach v,$(VIEWS),$(or $(wildcard $(v)),$(error no view at $(v))))
VIEW_NAMES := $(basename $(notdir $(VIEW_FILES)))
$(foreach v,$(VIEW_FILES),$(call check_name,VIEWS,$(v)))
$(if $(filter-out %.json,$(VIEW_FILES)),$(error VIEWS: not a .json file: $(filter-out %.json,$(VIEW_FILES))))
$(if $(filter-out $(words $(sort $(VIEW_NAMES))),$(words $(VIEW_NAMES))),$(error VIEWS: two files of one name: $(VIEW_FILES)))
# LISTS are the view files that hold a list of views, which gather tells from the others: it must be built by now.
ifeq ($(wildcard $(GATHER)),)
include $(BIN)/built.mk
endif
$(BIN)/built.mk: | build
	@touch $@
LISTS := $(shell for view in $(VIEW_FILES); do \
  case $$($(GATHER) --list-images --quiet --view $$view -o image.exr 2>/dev/null) in (image.*.exr) echo $$view; esac; done)
# The images of a list NAME.json are NAME.VIEW.exr. NAME.views is written when all of them are there, and lists them.
$(foreach l,$(basename $(notdir $(LISTS))),$(if $(filter $(l).%,$(VIEW_NAMES)),$(error VIEWS: an image of the list $(l).json could \
  have the name of that of $(firstword $(filter $(l).%,$(VIEW_NAMES))).json; rename one of them)))
picture_of = $(notdir $(basename $(1))).$(if $(filter $(1),$(LISTS)),views,exr)
OWN_PICTURES := $(foreach v,$(VIEW_FILES),$(call picture_of,$(v)))
else
# gather lists the cameras of the file. Make writes that list first, and then reads it.
include $(OWN).cameras
# Cameras of the file are known by their index, those that are made by their name.
OWN_PICTURES := $(foreach c,$(CAMERAS),$(call camera_of,$(c)).exr)
endif

own: $(OWN_PICTURES:%=$(OWN_IMAGES)/%)
	@echo "The pictures are in $(OWN_IMAGES)/: one .png and one OpenEXR image for each view."
	@$(say_if_refused)

$(OWN).cameras: $(SCENE) $(OWN).settings | $(GATHER)
	@$(GATHER) --list-cameras --quiet '$<' > $@.list
	@sed -n -e 's/^[0-9][0-9]* *\([a-z]*\) .*  - (made)$$/CAMERAS += \1/p' -e t -e 's/^\([0-9][0-9]*\) .*/CAMERAS += \1/p' $@.list > $@
	@rm $@.list
	@test -s $@ || { echo "$<: it has no camera, and nothing to see; give VIEWS='path/*.json'" >&2; exit 2; }

$(OWN).cloud: $(SCENE) $(OWN).settings crates/formats/cloud-version | $(SAMPLE)
	$(SUBMIT) $(SAMPLE) --threads $(THREADS) --seed $(SEED) --samples $(SAMPLES) $(foreach t,$(TRANSLUCENT),--translucent $(call quoted,$(t))) \
	  $(own_scene) '$<' -o $@

# $(call lost_of_list,NAME.views) remakes a list of which an image or a preview is missing.
lost_of_list = $(shell cd $(dir $(1)) 2>/dev/null && while IFS= read -r image; do [ -e "$$image" ] && [ -e "$${image%.exr}.png" ] || \
  echo .FORCE; done 2>/dev/null < $(notdir $(1)))

# All pictures share one calibration. A scene that cannot be calibrated, which is said with exit code 2, is rendered
# without: its calibration is then an empty file.
ifneq ($(CALIBRATED),)
OWN_CALIBRATION := $(OWN_IMAGES).calibration
$(eval $(call settings,$(OWN_IMAGES),--walks $$(WALKS) --medium $$(MEDIUM),$(OWN_MEDIA)))
$(OWN_CALIBRATION): $(OWN).cloud $(OWN).settings $(OWN_IMAGES).settings crates/formats/calibration-version | $(CALIBRATOR)
	$(SUBMIT) $(CALIBRATOR) --threads $(THREADS) --seed $(SEED) --walks $(WALKS) --bssrdf $(MODEL) $(if $(MEDIUM),--medium $(MEDIUM)) $(own_scene) $< '$(SCENE)' -o $@ || \
	  { code=$$?; [ $$code = 2 ] || exit $$code; : > $@; }
own_calibrated = $$([ -s $(OWN_CALIBRATION) ] && echo --calibration $(OWN_CALIBRATION) || echo --calibration none $(if $(MEDIUM),--medium $(MEDIUM)))
say_if_refused = [ -s $(OWN_CALIBRATION) ] || echo "They are not calibrated: $(SCENE) was refused, as was said when $(OWN_CALIBRATION) was made."
else
own_calibrated = --calibration none $(if $(MEDIUM),--medium $(MEDIUM))
endif

# How a picture is made: by the model, or by random walks (truth.mk).
own_model     = --spp $(SPP) --bssrdf $(MODEL) $(own_calibrated)
own_reference = --reference --target-error $(ERROR) $(if $(MEDIUM),--medium $(MEDIUM))

# $(1) image, or the .views file of a list; $(2) view file, if it has one; $(3) options that choose camera and size;
# $(4) own_model or own_reference.
define own_picture
$(call settings,$(basename $(1)),--exposure $$(EXPOSURE) $$(own_seen) --medium $$(MEDIUM) $$($(4)) $(3),$(OWN_MEDIA) $(2))
$(1): $(OWN).cloud $(OWN).settings $(basename $(1)).settings $(if $(filter own_model,$(4)),$(OWN_CALIBRATION)) $(if $(filter \
  %.views,$(1)),$(call lost_of_list,$(1)),$(call unless_there,$(basename $(1)).png)) | $(GATHER)
	$$(SUBMIT) $(GATHER) --threads $$(THREADS) --seed $$(SEED) $$($(4)) $(3) \
	  $$(own_scene) $$(own_seen) --preview $$(basename $$@).png --exposure $$(or $$(EXPOSURE),0) $$< '$$(SCENE)' -o $$(basename $$@).exr
	$(if $(filter %.views,$(1)),@$(GATHER) --list-images --quiet $(3) -o $$(basename $$(@F)).exr > $$@)
endef
# $(call own_pictures,FOLDER,OPTIONS OF SIZE,own_model or own_reference)
own_pictures = $(foreach c,$(CAMERAS),$(eval $(call own_picture,$(1)/$(call camera_of,$(c)).exr,,--camera $(if $(filter $(MADE_CAMERAS),$(c)),$(c),index:$(c)) $(2),$(3))))$(foreach \
  v,$(VIEW_FILES),$(eval $(call own_picture,$(1)/$(call picture_of,$(v)),$(v),--view $(v) $(2),$(3))))
$(call own_pictures,$(OWN_IMAGES),,own_model)
endif
