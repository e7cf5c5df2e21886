# Whether pictures are calibrated (docs/guide.md): random walks measure once what the model gets wrong on a shape, and
# all pictures of that cloud and those media share the result, NAME.calibration beside their folder NAME. Offers
# CALIBRATED, which is empty where they are not: with CALIBRATE=no, and with the dipoles, which are rendered as they
# were published.

CALIBRATE ?= yes
# Random walks of each channel.
WALKS     ?= 300k
$(if $(CHECKED),$(if $(filter 1-yes 1-no,$(words $(CALIBRATE))-$(CALIBRATE)),,$(error CALIBRATE=$(CALIBRATE): it is yes or no)))
CALIBRATED := $(if $(filter half-space,$(MODEL)),$(filter yes,$(CALIBRATE)))
