# Installation: the programs, their manual pages, and the completions of their options for bash, fish and zsh, which the
# programs print about themselves. Offers install and uninstall, and the variables
#   PREFIX=/usr/local          below which they are installed
#   DESTDIR=                   a folder in which PREFIX lies while a package is made
#   PROGRAMS='gather compare'  those that are installed; ImageMagick has a program `compare` too

.PHONY: install uninstall

# The environment may hold variables of these names by chance.
ifeq ($(filter command% override,$(origin PREFIX)),)
PREFIX := /usr/local
endif
ifeq ($(filter command% override,$(origin PROGRAMS)),)
PROGRAMS := sample-surface calibrate gather compare
endif
$(if $(filter-out sample-surface calibrate gather compare,$(PROGRAMS)),$(error PROGRAMS=$(PROGRAMS): they are of sample-surface, calibrate, gather, compare))
INSTALLED := $(DESTDIR)$(PREFIX)
INSTALL   ?= install

# $(call installed,PROGRAM): its files below INSTALLED, each after the word that PCSSS_PRINT asks for.
installed = man:share/man/man1/$(1).1 bash:share/bash-completion/completions/$(1) \
  fish:share/fish/vendor_completions.d/$(1).fish zsh:share/zsh/site-functions/_$(1)
below     = $(call quoted,$(INSTALLED)/$(1))

# A text is made beside its place and moved there, so that a program that fails leaves none.
define install_text
d=$(call below,$(dir $(3))) f=$(call below,$(3)); mkdir -p "$$d" && PCSSS_PRINT=$(2) $(BIN)/$(1) > "$$f.new" && chmod 644 "$$f.new" && mv "$$f.new" "$$f"
endef
define install_program
@mkdir -p $(call below,bin) && $(INSTALL) -m 755 $(BIN)/$(1) $(call below,bin/$(1))
$(foreach t,$(call installed,$(1)),@$(call install_text,$(1),$(firstword $(subst :, ,$(t))),$(lastword $(subst :, ,$(t))))$(newline))
endef
define newline


endef

## install: the programs with their manual pages and completions to PREFIX=/usr/local, in DESTDIR if that is given
install: build
	$(foreach p,$(PROGRAMS),$(call install_program,$(p))$(newline))
	@printf '%s\n' $(call quoted,$(PROGRAMS): installed to $(INSTALLED))

## uninstall: remove what install wrote
uninstall:
	@rm -f $(foreach p,$(PROGRAMS),$(call below,bin/$(p)) $(foreach t,$(call installed,$(p)),$(call below,$(lastword $(subst :, ,$(t))))))
