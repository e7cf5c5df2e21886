# The table of the half-space model (docs/method.md, section 15), which is committed. Offers half-space-table.

.PHONY: half-space-table

## half-space-table: the table of the half-space model again, from random walks (minutes)
half-space-table:
	$(CARGO) run --release --quiet --package make-half-space-table -- crates/bssrdf/src/half_space/table.bin
