# Removal: `make clean` and `make clean-images` find the .settings files in OUT that begin with their own names, remove
# what was made with them, and then the folders that are empty. `make clean` also removes the exact images of reports,
# whose names in OUT/truth are digests. No other file in OUT was made by make, whatever its name, and no link in OUT is
# followed. Offers clean and clean-images.

.PHONY: clean clean-images

# Six times four hexadecimal digits.
HEX4   := [0-9a-f][0-9a-f][0-9a-f][0-9a-f]
DIGEST := $(HEX4)$(HEX4)$(HEX4)$(HEX4)$(HEX4)$(HEX4)

# $(1) images or all.
define remove
@out=$(call quoted,$(OUT)); case $$out in /*) ;; *) out=./$$out; esac; [ -d "$$out" ] || exit 0; \
(cd "$$out" && find . -maxdepth 4 -type f -name '*.settings' -exec sh -c ' \
  for file; do \
    name=$${file#./} name=$${name%.settings}; \
    [ "$$(head -n 1 "$$file")" = "made by make: $$name" ] || continue; \
    case $$name in */*) folder=$${name%/*} ;; *) folder=. ;; esac; \
    rm -f "$$name.exr" "$$name.png" "$$name.html"; \
    [ ! -f "$$name.views" ] || while IFS= read -r image; do \
      case $$image in */*) ;; *.exr) rm -f "$$folder/$$image" "$$folder/$${image%.exr}".png "$$folder/$${image%.exr}".html; esac; done < "$$name.views"; \
    case $$name in check/*/image) rm -f "$$folder"/[0-9]*.exr; esac; \
    if [ $(1) = all ]; then \
      case $$name in check/*/cloud) rm -f "$$folder"/[0-9]*.cloud "$$folder.json"; esac; \
      rm -f "$$folder/.$${name##*/}".*.tmp "$$name.cloud" "$$name.calibration" "$$name.views" "$$name.media" "$$name.cameras" "$$name.cameras.list" "$$file"; \
    fi; \
    while [ "$$folder" != . ] && rmdir "$$folder" 2>/dev/null; do \
      case $$folder in */*) folder=$${folder%/*} ;; *) folder=. ;; esac; done; \
  done' sh {} +); \
[ $(1) = images ] || [ -L "$$out/truth" ] || { rm -f "$$out"/truth/$(DIGEST)-[12].exr; rmdir "$$out/truth" 2>/dev/null; }; \
rmdir "$$out" 2>/dev/null || [ -z "$$(ls -A "$$out")" ] || [ $(1) = images ] || \
  printf '%s\n' $(call quoted,$(OUT) stays: it holds what this Makefile did not make)
endef

## clean-images: remove images and their pages, keep clouds and calibrations
clean-images:
	$(call remove,images)

## clean: remove all that was rendered, and nothing else
clean:
	$(call remove,all)
