# aebmc: one non-recursive Makefile. Objects live in $(O) (build/ unless a variant says otherwise).
#
#   make            the daemon and the tool           make demo    build and replay the bundled drive
#   make check      every test without an emulator    make deps    name (and as root install) the packages
#   V=1 shows commands, WERROR=1 makes warnings errors, CC=clang changes the compiler.

VERSION := 0.1.0
O       ?= build
ifeq ($(origin CC),default)
CC      := gcc
endif
AR      := $(CROSS)ar
ARCH    := $(shell $(CC) -dumpmachine | cut -d- -f1)

Q       := $(if $(V),,@)
say     = $(if $(V),,@printf '  %-7s %s\n' '$(1)' '$(2)')

# ---- flags -----------------------------------------------------------------------------------
# Bit-equality: no contraction, no fast-math; -fno-trapping-math -fno-math-errno (-fno-tree-pre for
# the lane loops, gcc only) change no value and are what lets the compiler vectorise.
WARN    := -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wpointer-arith \
	   -Wundef -Wvla -Wwrite-strings -Wno-unknown-warning-option
WARN    += $(if $(WERROR),-Werror)
OPT     ?= -O2 -g
NUMERIC := -ffp-contract=off -fno-math-errno -fno-trapping-math
HARDEN  := -fstack-protector-strong
CFLAGS_ALL = -std=gnu17 $(OPT) $(WARN) $(NUMERIC) $(HARDEN) -pthread -Ikernels -Ican-dbc -Idaemon -Itools \
	   -I$(O)/gen $(if $(SAN),-fsanitize=$(SAN) -fno-sanitize-recover=all -fno-omit-frame-pointer) \
	   $(EXTRA_CFLAGS) $(CFLAGS)
LDFLAGS_ALL = -pthread $(if $(SAN),-fsanitize=$(SAN)) $(LDFLAGS)
LDLIBS  := -lm

IS_CLANG := $(findstring clang,$(shell $(CC) --version 2>/dev/null | head -n 1))
LANE_OPT := -O3 $(if $(IS_CLANG),,-fno-tree-pre)

# ---- lane variants: one source, one object per instruction set, picked at run time ---------------
LANES_x86_64  := plain avx2 avx512
LANES_aarch64 := neon
LANES         := $(or $(LANES_$(ARCH)),plain)
LANEFLAGS_plain  :=
LANEFLAGS_avx2   := -march=x86-64-v3
LANEFLAGS_avx512 := -march=x86-64-v4 -mprefer-vector-width=512
LANEFLAGS_neon   :=

# ---- sources -----------------------------------------------------------------------------------
LANE_SRC   := kernels/lanes.c
MC_SRC     := $(filter-out $(LANE_SRC),$(wildcard kernels/*.c)) $(wildcard can-dbc/*.c)
DAEMON_SRC := $(filter-out daemon/main.c,$(wildcard daemon/*.c))
TOOL_SRC   := $(wildcard tools/*.c)
TEST_SRC   := $(wildcard tests/test_*.c)

obj        = $(patsubst %.c,$(O)/%.o,$(1))
LANE_OBJ   := $(foreach v,$(LANES),$(O)/kernels/lanes_$(v).o)
LIBMC      := $(O)/libaebmc.a
LIBD       := $(O)/libaebmcd.a
TESTS      := $(patsubst tests/%.c,$(O)/tests/%,$(TEST_SRC))

.DEFAULT_GOAL := all
.PHONY: all clean demo check check-unit check-san check-arm64 deps format format-check
.SECONDARY:
all: $(O)/aebmcd $(O)/aebmc

$(LIBMC): $(call obj,$(MC_SRC)) $(LANE_OBJ)
	$(call say,AR,$@)
	$(Q)rm -f $@ && $(AR) rcs $@ $^
$(LIBD): $(call obj,$(DAEMON_SRC))
	$(call say,AR,$@)
	$(Q)rm -f $@ && $(AR) rcs $@ $^
$(O)/aebmcd: $(O)/daemon/main.o $(LIBD) $(LIBMC)
	$(call say,LD,$@)
	$(Q)$(CC) $(LDFLAGS_ALL) -o $@ $^ $(LDLIBS)
$(O)/aebmc: $(call obj,$(TOOL_SRC)) $(LIBD) $(LIBMC)
	$(call say,LD,$@)
	$(Q)$(CC) $(LDFLAGS_ALL) -o $@ $^ $(LDLIBS)

$(O)/%.o: %.c $(O)/flags
	$(call say,CC,$@)
	$(Q)mkdir -p $(@D) && $(CC) $(CFLAGS_ALL) -MMD -MP -c -o $@ $<
$(O)/kernels/lanes_%.o: $(LANE_SRC) $(O)/flags
	$(call say,CC,$@)
	$(Q)mkdir -p $(@D) && $(CC) $(CFLAGS_ALL) $(LANE_OPT) $(LANEFLAGS_$*) -DLANE_VARIANT=$* -MMD -MP -c -o $@ $<
# Rebuild everything when compiler or flags change.
$(O)/flags: FORCE
	$(Q)mkdir -p $(O) && echo '$(CC) $(CFLAGS_ALL) $(LANE_OPT) $(LANES)' | cmp -s - $@ || \
	echo '$(CC) $(CFLAGS_ALL) $(LANE_OPT) $(LANES)' > $@
FORCE:

# ---- tests -------------------------------------------------------------------------------------
CMOCKA_LIBS := -lcmocka
$(O)/tests/%: $(O)/tests/%.o $(LIBD) $(LIBMC)
	$(call say,LD,$@)
	$(Q)$(CC) $(LDFLAGS_ALL) -o $@ $^ $(CMOCKA_LIBS) $(LDLIBS)

clean:
	rm -rf $(O)

-include $(shell find $(O) -name '*.d' 2>/dev/null)
