# aebmc: one non-recursive Makefile. Objects live in $(O) (build/ unless a variant says otherwise).
#
#   make            the daemon and the tool           make demo    build and replay the bundled drive
#   make check      every test without an emulator    make deps    name (and as root install) the packages
#   V=1 shows commands, WERROR=1 makes warnings errors, CC=clang changes the compiler.

MAKEFLAGS += --no-builtin-rules
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
# What a row of a table leaves out is 0: no warning about it.
# Bit-equality: no contraction, no fast-math; -fno-trapping-math -fno-math-errno (-fno-tree-pre for
# the lane loops, gcc only) change no value and are what lets the compiler vectorise.
WARN    := -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wpointer-arith \
	   -Wundef -Wvla -Wwrite-strings -Wno-missing-field-initializers
WARN    += $(if $(WERROR),-Werror)
OPT     ?= -O2 -g
NUMERIC := -ffp-contract=off -fno-math-errno -fno-trapping-math
HARDEN  := -fstack-protector-strong
CFLAGS_ALL = -std=gnu17 -D_GNU_SOURCE $(OPT) $(WARN) $(NUMERIC) $(HARDEN) -pthread -Ikernels -Ican-dbc -Idaemon -Itools \
	   -I$(O)/gen $(if $(SAN),-fsanitize=$(SAN) -fno-sanitize-recover=all -fno-omit-frame-pointer) \
	   $(CUDA_CFLAGS) $(if $(TRACE_SO),-DTRACE_PROVIDERS) $(EXTRA_CFLAGS) $(CFLAGS)
LDFLAGS_ALL = -pthread $(if $(SAN),-fsanitize=$(SAN)) $(LDFLAGS)
LDLIBS   = -lm $(CUDA_LIBS)

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

# ---- optional libraries --------------------------------------------------------------------------
# WITH_X = auto (use it if its header is there) | yes (fail without it) | no. Each chooses between two files of the same
# face: NAME_LIB.c and NAME_none.c.
WITH_SYSTEMD   ?= auto
WITH_SOCKETCAN ?= auto
WITH_LTTNG     ?= auto
WITH_BABELTRACE ?= auto
has_header = $(shell printf '\043include <%s>\n' $(1) | $(CC) -E -x c - >/dev/null 2>&1 && echo yes)
# $(call choose,WITH_X,header,package): yes or nothing
choose     = $(if $(filter no,$($(1))),,$(or $(call has_header,$(2)),$(if $(filter yes,$($(1))),$(error $(1)=yes but \
	     <$(2)> is missing: apt-get install $(3)))))
SYSTEMD    := $(call choose,WITH_SYSTEMD,systemd/sd-daemon.h,libsystemd-dev)
SOCKETCAN  := $(call choose,WITH_SOCKETCAN,libsocketcan.h,libsocketcan-dev)
LTTNG      := $(call choose,WITH_LTTNG,lttng/tracepoint.h,liblttng-ust-dev)
BABELTRACE := $(call choose,WITH_BABELTRACE,babeltrace2/babeltrace.h,libbabeltrace2-dev)
OPTIONAL   := daemon/service_$(if $(SYSTEMD),systemd,none).c daemon/link_$(if $(SOCKETCAN),socketcan,none).c
OPTIONAL   += tools/ctf_$(if $(BABELTRACE),babeltrace,none).c
NOT_CHOSEN := $(filter-out $(OPTIONAL),$(wildcard daemon/service_*.c daemon/link_*.c tools/ctf_*.c))
TOOL_LIBS  := $(if $(BABELTRACE),-lbabeltrace2)
LDLIBS     += $(if $(SYSTEMD),-lsystemd) $(if $(SOCKETCAN),-lsocketcan)

# ---- sources -----------------------------------------------------------------------------------
LANE_SRC   := kernels/lanes.c
TRACE_SRC  := daemon/trace_lttng.c daemon/trace_nvtx.c
MC_SRC     := $(filter-out $(LANE_SRC),$(wildcard kernels/*.c)) $(wildcard can-dbc/*.c)
DAEMON_SRC := $(filter-out daemon/main.c $(TRACE_SRC) $(NOT_CHOSEN),$(wildcard daemon/*.c))
TOOL_SRC   := $(filter-out $(NOT_CHOSEN),$(wildcard tools/*.c))
TEST_SRC   := $(wildcard tests/test_*.c)

# ---- CUDA --------------------------------------------------------------------------------------
# WITH_CUDA=auto|yes|no. nvcc compiles kernels/mc_cuda.cu alone, to machine code for Jetson Orin (sm_87), Hopper (sm_90)
# and this machine's device. Without nvcc, or for another processor, backend cuda is refused by name.
WITH_CUDA   ?= auto
comma       := ,
NVCC        := $(firstword $(shell command -v nvcc 2>/dev/null) $(wildcard /usr/local/cuda/bin/nvcc))
CUDA_ROOT   := $(patsubst %/bin/nvcc,%,$(realpath $(NVCC)))
# A cross build names its C++ compiler, CUDA_CCBIN, and the folder of the target's libcudart_static.a, CUDA_LIB.
CUDA_CCBIN  ?=
CUDA_LIB    ?= $(CUDA_ROOT)/lib64
CUDA_FOUND  := $(and $(or $(filter $(ARCH),$(shell uname -m)),$(CUDA_CCBIN)),$(wildcard $(CUDA_LIB)/libcudart_static.a),$(shell \
	       command -v $(or $(CUDA_CCBIN),g++)),$(NVCC))
HAVE_CUDA   := $(if $(filter no,$(WITH_CUDA)),,$(CUDA_FOUND))
ifeq ($(WITH_CUDA)-$(HAVE_CUDA),yes-)
$(error WITH_CUDA=yes, but no nvcc on PATH or in /usr/local/cuda/bin, or no g++, for $(ARCH))
endif
CUDA_SRC    := kernels/cuda_calls.c $(wildcard kernels/mc_cuda*.c)
CUDA_NONE   := kernels/mc_cuda_none.c
MC_SRC      := $(filter-out $(if $(HAVE_CUDA),$(CUDA_NONE),$(filter-out $(CUDA_NONE),$(CUDA_SRC))),$(MC_SRC))
TEST_SRC    := $(filter-out $(if $(HAVE_CUDA),,tests/test_cuda%),$(TEST_SRC))
CUDA_OBJ    := $(if $(HAVE_CUDA),$(O)/kernels/mc_cuda.cu.o)
CUDA_CFLAGS := $(if $(HAVE_CUDA),-isystem $(CUDA_ROOT)/include)
CUDA_LIBS   := $(if $(HAVE_CUDA),$(CUDA_LIB)/libcudart_static.a -ldl -lrt)
CUDA_SM     := $(sort 87 90 $(if $(HAVE_CUDA),$(shell $(CUDA_ROOT)/bin/__nvcc_device_query 2>/dev/null | tr ',' ' ')))
NVCC_FLAGS  := $(CUDA_CCBIN:%=-ccbin % -isystem $(CUDA_ROOT)/include) -std=c++17 -O3 --fmad=false --ftz=false --prec-div=true --prec-sqrt=true -Ikernels \
	       -Xcompiler -Wall,-Wextra,-Wno-missing-field-initializers,-ffp-contract=off,-fno-exceptions,-fno-threadsafe-statics
$(O)/kernels/mc_cuda.cu.o: kernels/mc_cuda.cu tools/ptxas-report $(O)/flags
	$(call say,NVCC,$@)
	$(Q)mkdir -p $(@D) && $(NVCC) $(NVCC_FLAGS) $(foreach m,$(CUDA_SM),-gencode arch=compute_$m,code=sm_$m) -Xptxas -v \
		-MMD -MP -MF $(@:.o=.d) -c -o $@ $< 2>$@.log || { cat $@.log; exit 1; }
	$(Q)tools/ptxas-report $@.log || { rm -f $@; exit 1; }
	$(Q)printf '%s="%s"\n' NVCC '$(NVCC)' NVCC_FLAGS '$(NVCC_FLAGS)' CUDA_ROOT '$(CUDA_ROOT)' >$(O)/cuda.env
# What auto found, once for each tree and whenever it changes.
CUDA_WORDS := $(if $(HAVE_CUDA),$(NVCC) for sm_$(subst $() ,$(comma) sm_,$(CUDA_SM)),not built in (WITH_CUDA=$(WITH_CUDA)): backend cuda is refused by name)
$(O)/cuda-found: FORCE
	$(Q)mkdir -p $(O) && echo '$(CUDA_WORDS)' | cmp -s - $@ || { echo '$(CUDA_WORDS)' >$@; printf '  %-7s %s\n' CUDA '$(CUDA_WORDS)'; }
# The same with kernels that do wrong on purpose; for tests/gpu/faults.c alone.
$(O)/kernels/mc_cuda_faults.cu.o: kernels/mc_cuda.cu tests/gpu/faults.cuh $(O)/flags
	$(call say,NVCC,$@)
	$(Q)mkdir -p $(@D) && $(NVCC) $(NVCC_FLAGS) $(foreach m,$(CUDA_SM),-gencode arch=compute_$m,code=sm_$m) \
		-DMC_CUDA_FAULTS -MMD -MP -MF $(@:.o=.d) -c -o $@ $<

# ---- tracing -----------------------------------------------------------------------------------
# Providers of trace events: shared objects that the daemon loads only when trace.provider asks for one.
TRACE_SO := $(if $(LTTNG),$(O)/trace-lttng.so) $(if $(HAVE_CUDA),$(O)/trace-nvtx.so)
TRACE_SO := $(strip $(TRACE_SO))
$(O)/trace-lttng.so: TRACE_LIBS := -llttng-ust
$(O)/trace-%.so: daemon/trace_%.c $(O)/flags
	$(call say,LD,$@)
	$(Q)mkdir -p $(@D) && $(CC) $(CFLAGS_ALL) -fPIC -shared $(LDFLAGS_ALL) -MMD -MP -MF $(@:.so=.so.d) -MT $@ \
		-o $@ $< $(TRACE_LIBS)

obj        = $(patsubst %.c,$(O)/%.o,$(1))
LANE_OBJ   := $(foreach v,$(LANES),$(O)/kernels/lanes_$(v).o)
LIBMC      := $(O)/libaebmc.a
LIBD       := $(O)/libaebmcd.a
TESTS      := $(patsubst tests/%.c,$(O)/tests/%,$(TEST_SRC))

.DEFAULT_GOAL := all
.PHONY: all clean demo format
.SECONDARY:
all: $(O)/cuda-found $(O)/aebmcd $(O)/aebmc $(TRACE_SO)

$(LIBMC): $(call obj,$(MC_SRC)) $(LANE_OBJ) $(CUDA_OBJ)
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
	$(Q)$(CC) $(LDFLAGS_ALL) -o $@ $^ $(LDLIBS) $(TOOL_LIBS)

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
.PHONY: FORCE
FORCE:

# ---- tests -------------------------------------------------------------------------------------
# A test is a program that speaks TAP: cmocka programs tests/test_*.c and scripts tests/*.sh.
# RUN_FLAGS=--strict fails on a skip that this machine could run (CI).
RUN_FLAGS  ?=
SCRIPTS    := $(sort $(filter-out tests/tap.sh tests/deb.sh,$(wildcard tests/*.sh)))
# What test programs need of the tools beyond what they include.
INPUTS_OBJ := $(call obj,$(filter-out tools/inputs.c,$(wildcard tools/inputs_*.c)) tools/stretch.c tools/census.c)
$(O)/tests/test_inputs: $(INPUTS_OBJ) $(call obj,tools/foreign.c)
$(O)/tests/test_fuzz: $(INPUTS_OBJ) $(call obj,$(wildcard tools/mapper_*.c))
$(O)/tests/%: $(O)/tests/%.o $(LIBD) $(LIBMC)
	$(call say,LD,$@)
	$(Q)$(CC) $(LDFLAGS_ALL) -o $@ $(filter %.o,$^) $(filter %.a,$^) -lcmocka $(LDLIBS)

# A drive made up for the tracer, beside the provider that it loads.
$(O)/made-up-trace: $(O)/tests/trace/made_up.o $(LIBD) $(LIBMC)
	$(call say,LD,$@)
	$(Q)$(CC) $(LDFLAGS_ALL) -o $@ $^ $(LDLIBS)

# On a machine with a GPU: everything about the CUDA backend, with gcc, make and nvcc alone. Log: $(O)/gpu/record.txt.
GPU_TESTS := $(patsubst tests/gpu/%.c,$(O)/tests/gpu/%,$(wildcard tests/gpu/*.c))
$(O)/tests/gpu/faults: $(O)/kernels/mc_cuda_faults.cu.o
$(O)/tests/gpu/%: $(O)/tests/gpu/%.o $(LIBD) $(LIBMC)
	$(call say,LD,$@)
	$(Q)$(CC) $(LDFLAGS_ALL) -o $@ $(filter %.o,$^) $(filter %.a,$^) $(LDLIBS)
.PHONY: check-gpu
check-gpu: all $(GPU_TESTS)
	$(Q)O=$(O) tests/gpu/check.sh

.PHONY: check check-unit check-san check-clang check-arm64 check-system check-coverage check-mutants tests
tests: $(TESTS) $(O)/made-up-trace
check: deps-check all tests
	$(Q)O=$(O) tests/run $(RUN_FLAGS) --log $(O)/log $(TESTS) $(SCRIPTS)
# Tests alone, with what stands before each program (an emulator) and scripts chosen by the caller. STATISTICS repeat a
# figure thousands of times on bits that other tests hold equal: once, natively, says it all.
STATISTICS := $(O)/tests/test_interval
check-unit: all tests
	$(Q)O=$(O) tests/run $(RUN_FLAGS) --log $(O)/log --wrap '$(WRAP)' $(filter-out $(STATISTICS),$(TESTS)) $(UNIT_SCRIPTS)

# From wake-up to frame on this machine, 40 s of a made-up drive over a socketpair; as root with real-time priorities.
.PHONY: bench-wakeup
bench-wakeup: $(O)/aebmc $(O)/tests/bench_wakeup
	$(Q)$(O)/aebmc generate --drive follow | $(O)/tests/bench_wakeup can-dbc/vehicles/generic.conf

# Sanitizers: the unit tests and the command-line tests that feed bad input, in trees of their own. cli_explain.sh is about
# figures and takes many minutes there.
SAN_SCRIPTS := $(filter-out tests/cli_explain.sh,$(filter tests/cli_%.sh tests/check_config.sh,$(SCRIPTS)))
SUB         := $(MAKE) WERROR=$(WERROR) RUN_FLAGS='$(RUN_FLAGS)' WITH_CUDA=no
check-san: deps-check
	+$(Q)$(SUB) O=build/asan OPT='-O1 -g' SAN=address,undefined UNIT_SCRIPTS='$(SAN_SCRIPTS)' check-unit
	+$(Q)$(SUB) O=build/tsan OPT='-O1 -g' SAN=thread check-unit
check-clang: deps-check
	+$(Q)$(SUB) O=build/clang CC=clang check-unit

# What protects the car is held closely: every line and branch of these files is tested, and what a mutant changes in
# them is noticed (tests/mutate; SAMPLE=0 tries every mutant and takes about an hour, CI takes a share).
HELD        = $(shell tests/mutate --files)
HELD_TESTS  = $(wildcard $(foreach t,$(shell tests/mutate --tests),tests/test_$t.c))
SAMPLE     ?= 100
check-coverage: deps-check
	+$(Q)$(SUB) O=build/coverage CC=gcc OPT='-O0 -g' EXTRA_CFLAGS=--coverage LDFLAGS=--coverage TEST_SRC='$(HELD_TESTS)' \
		run-covered
check-mutants: deps-check
	+$(Q)$(SUB) O=build/mutants CC=gcc OPT='-O0 -g' SAN=address,undefined TEST_SRC='$(HELD_TESTS)' run-mutants
.PHONY: run-covered run-mutants
run-covered: tests
	$(Q)find $(O) -name '*.gcda' -delete
	$(Q)O=$(O) tests/run $(RUN_FLAGS) --log $(O)/log $(TESTS) && O=$(O) HELD='$(HELD)' tests/run --log $(O)/log tests/covered
run-mutants: tests
	$(Q)O=$(O) CC='$(CC) $(CFLAGS_ALL)' LIBS='$(LDFLAGS_ALL) -lcmocka $(LDLIBS)' SAMPLE=$(SAMPLE) \
		tests/run $(RUN_FLAGS) --log $(O)/log tests/mutate

# Hostile files by the million: DBCs, configurations, logs, mutated and read under the sanitizers.
FUZZ_INPUTS := 1000000
.PHONY: fuzz
fuzz: deps-check
	+$(Q)$(SUB) O=build/asan OPT='-O1 -g' SAN=address,undefined build/asan/tests/test_dbc_fuzz build/asan/tests/test_fuzz
	$(Q)FUZZ_INPUTS=$$(($(FUZZ_INPUTS) / 2)) build/asan/tests/test_dbc_fuzz
	$(Q)FUZZ_INPUTS=$$(($(FUZZ_INPUTS) / 2)) build/asan/tests/test_fuzz

# 64-bit Arm: cross-built, run under emulation; tests compare results with the same known answers, bit for bit.
ARM := aarch64-linux-gnu
check-arm64: deps-arm64 all
	+$(Q)$(SUB) O=build/arm64 CC=$(ARM)-gcc CROSS=$(ARM)- WRAP='qemu-aarch64-static' check-unit
	$(Q)O=build/arm64 HOST_O=$(O) tests/run $(RUN_FLAGS) --log build/arm64/log tests/arm64/same_bits.sh \
		$(if $(HAVE_CUDA),tests/arm64/cuda.sh)

# The live daemon as a service in a virtual machine with a PREEMPT_RT kernel (tests/system/).
SYSTEM_TOOLS := $(patsubst %.c,$(O)/%,$(wildcard tests/system/*.c))
$(O)/tests/system/%: $(O)/tests/system/%.o
	$(call say,LD,$@)
	$(Q)$(CC) $(LDFLAGS_ALL) -o $@ $^
check-system: deps-system deps-deb all $(SYSTEM_TOOLS)
	$(Q)mkdir -p $(O)/log && tests/system/image.sh >/dev/null
	$(Q)O=$(O) tests/run $(RUN_FLAGS) --lines --jobs 2 --log $(O)/log tests/system/timing.sh tests/system/behaviour.sh tests/system/trace.sh tests/system/deb.sh

# ---- packages ------------------------------------------------------------------------------------
# Debian packages by apt; PyPI only for test oracles. As root they are installed, otherwise named.
DEPS_BUILD  := gcc libc6-dev make
DEPS_CHECK  := $(DEPS_BUILD) clang clang-format gcovr python3 python3-venv python3-mpmath libcmocka-dev xz-utils shellcheck \
	       systemd scdoc libsystemd-dev libsocketcan-dev librsvg2-bin liblttng-ust-dev lttng-tools libbabeltrace2-dev
ARM64_LIBS  := libcmocka-dev libsystemd-dev libsocketcan-dev liblttng-ust-dev libbabeltrace2-dev
DEPS_ARM64  := $(DEPS_CHECK) gcc-aarch64-linux-gnu g++-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user-static $(ARM64_LIBS:%=%:arm64)
DEPS_SYSTEM := $(DEPS_CHECK) mmdebstrap qemu-system-x86 qemu-utils busybox-static e2fsprogs kmod cpio
DEPS_DEB    := $(DEPS_CHECK) debhelper dpkg-dev fakeroot lintian xz-utils
VENV       := build/venv
.PHONY: deps deps-build deps-check deps-arm64 deps-system deps-deb
deps: deps-check
deps-build:
	$(Q)tools/deps $(DEPS_BUILD)
deps-check:
	$(Q)tools/deps $(DEPS_CHECK)
	$(Q)test -x $(VENV)/bin/python || python3 -m venv $(VENV)
	$(Q)$(VENV)/bin/python -c 'import cantools, can, mcap, asammdf' 2>/dev/null || \
	$(VENV)/bin/pip install -q cantools python-can mcap asammdf || \
	echo 'cantools, python-can, mcap and asammdf could not be installed from PyPI: their tests will be skipped'
	$(Q)test -z '$(HAVE_CUDA)' || test -d $(VENV)/lib/python3*/site-packages/nvidia/cuda_runtime || \
	$(VENV)/bin/pip install -q nvidia-cuda-runtime-cu12==12.6.77 || \
	echo 'the CUDA 12.6 runtime could not be installed from PyPI: its test will be skipped'
deps-arm64: deps-check
	$(Q)tools/deps $(DEPS_ARM64)
deps-deb: deps-check
	$(Q)tools/deps $(DEPS_DEB)
deps-system: deps-check
	$(Q)tools/deps $(DEPS_SYSTEM)

# ---- demo ----------------------------------------------------------------------------------------
demo: deps-build all
	$(Q)mkdir -p $(O)/demo
	$(Q)$(O)/aebmc generate --drive brake --out $(O)/demo/brake.log
	$(Q)$(O)/aebmc replay --config can-dbc/vehicles/generic.conf --out $(O)/demo/out.log --csv $(O)/demo/out.csv \
		$(O)/demo/brake.log
	$(Q)$(O)/aebmc plot $(O)/demo/out.csv --from 17 --title 'The lead brakes, the driver does nothing' \
		--out $(O)/demo/timeline.svg
	@echo
	@echo 'The last seconds as a picture, for any browser: $(O)/demo/timeline.svg'
	@echo 'The drive as CAN frames: $(O)/demo/brake.log; what the daemon would send: $(O)/demo/out.log. In words:'
	@echo '  $(O)/aebmc decode --config can-dbc/vehicles/generic.conf $(O)/demo/out.log | less'
	@echo 'Other drives: $(O)/aebmc generate --list. Your own log: README.md, "Your own log".'

# ---- what --version says ---------------------------------------------------------------------------
# A tarball of `make dist` carries the commit in the file .commit.
GIT_COMMIT := $(or $(shell git describe --always --dirty=-modified --abbrev=12 --exclude '*' 2>/dev/null),$(shell \
	cat .commit 2>/dev/null),unknown)
CC_NAME    := $(shell $(CC) --version 2>/dev/null | head -n 1 | tr -d '"\\')
CUDA_NAME  := $(if $(HAVE_CUDA),$(shell $(NVCC) --version | sed -n 's/.*release \([0-9.]*\).*/\1/p') for sm $(CUDA_SM),none)
$(O)/gen/build.h: FORCE
	$(Q)mkdir -p $(@D) && printf '#define BUILD_%s "%s"\n' COMMIT '$(GIT_COMMIT)' COMPILER '$(CC_NAME)' \
		CUDA '$(CUDA_NAME)' >$@.new && { cmp -s $@.new $@ && rm $@.new || mv $@.new $@; }
$(O)/daemon/build_info.o: $(O)/gen/build.h

# ---- what was measured on a GPU, for aebmc paper -----------------------------------------------------
$(O)/gen/record.def: tests/gpu/record-h200.txt tools/record-def
	$(Q)mkdir -p $(@D) && tools/record-def $< >$@.new && mv $@.new $@
$(O)/tools/record.o: $(O)/gen/record.def

# ---- manual ------------------------------------------------------------------------------------------
# scdoc files beside the programs; OPTIONS of aebmcd.conf(5) is what the daemon itself prints. Without scdoc, or where
# the daemon cannot run (a cross build), there are none.
MAN_ALL := $(O)/man/aebmcd.8 $(O)/man/aebmc.1 $(O)/man/aebmcd.conf.5
MAN     := $(if $(CROSS),,$(if $(shell command -v scdoc),$(MAN_ALL)))
.PHONY: man
man: $(MAN)
	$(if $(MAN),,@echo 'no man pages: scdoc is missing (apt-get install scdoc), or this is a cross build')
$(O)/man/%: daemon/%.scd
	$(call say,SCDOC,$@)
	$(Q)mkdir -p $(@D) && SOURCE_DATE_EPOCH=0 scdoc <$< >$@
$(O)/man/aebmc.1: tools/aebmc.1.scd tools/cmd.def
	$(call say,SCDOC,$@)
	$(Q)mkdir -p $(@D) && sed -n 's/^CMD(\([a-z]*\), "\(.*\)")$$/*\1*\n\t\2\n/p' tools/cmd.def >$@.subcommands
	$(Q)sed -e '/^@SUBCOMMANDS@/{r $@.subcommands' -e 'd}' $< | SOURCE_DATE_EPOCH=0 scdoc >$@
$(O)/man/aebmcd.conf.5: daemon/aebmcd.conf.5.scd $(O)/aebmcd
	$(call say,SCDOC,$@)
	$(Q)mkdir -p $(@D) && $(O)/aebmcd --print-options >$@.options
	$(Q)sed -e '/^@OPTIONS@/{r $@.options' -e 'd}' $< | SOURCE_DATE_EPOCH=0 scdoc >$@

# ---- install -----------------------------------------------------------------------------------------
# make install PREFIX=/usr DESTDIR=...: no file outside the prefix; configurations in /etc/aebmc are the user's.
PREFIX  ?= /usr/local
UNITS   := $(patsubst %,$(O)/units/%,$(notdir $(wildcard systemd/*.service rt-config/*.service)))
# mode:source:place below the prefix
INSTALLED := 755:$(O)/aebmcd:sbin/aebmcd 755:$(O)/aebmc:bin/aebmc \
	644:systemd/aebmc.sysusers:lib/sysusers.d/aebmc.conf 644:systemd/aebmc.tmpfiles:lib/tmpfiles.d/aebmc.conf \
	644:systemd/60-aebmc.rules:lib/udev/rules.d/60-aebmc.rules \
	644:systemd/80-aebmc-can.network:share/aebmc/80-aebmc-can.network \
	644:tools/aebmc.bash:share/bash-completion/completions/aebmc \
	644:can-dbc/aebmc.dbc:share/aebmc/aebmc.dbc \
	$(foreach f,$(TRACE_SO),755:$f:lib/aebmc/$(notdir $f)) \
	$(foreach f,$(wildcard can-dbc/vehicles/*),644:$f:share/aebmc/vehicles/$(notdir $f)) \
	$(foreach f,$(filter-out %.service,$(wildcard rt-config/*)),$(if $(findstring .,$(notdir $f)),644,755):$f:share/aebmc/$f) \
	$(foreach f,$(UNITS),644:$f:lib/systemd/system/$(notdir $f)) \
	$(foreach f,$(MAN),644:$f:share/man/man$(subst .,,$(suffix $f))/$(notdir $f))
.PHONY: install uninstall dist
# Units name the programs where they are installed.
$(UNITS): $(O)/units/%: FORCE
	$(Q)mkdir -p $(@D) && sed -E '/^Exec/s|/usr/(sbin/aebmcd\|share/aebmc)|$(PREFIX)/\1|' \
		$(wildcard systemd/$(@F) rt-config/$(@F)) >$@
install: all man $(UNITS)
	$(Q)set -e; for f in $(INSTALLED); do \
		mode=$${f%%:*}; to=$${f##*:}; from=$${f#*:}; from=$${from%:*}; \
		install -D -m $$mode "$$from" "$(DESTDIR)$(PREFIX)/$$to"; done
	$(if $(DESTDIR),,@echo 'now as root: systemd-sysusers; systemd-tmpfiles --create; udevadm control --reload; \
	udevadm trigger -n cpu_dma_latency; systemctl daemon-reload')
uninstall:
	$(Q)for f in $(INSTALLED) $(MAN_ALL:$(O)/man/%=::share/man/man*/%); do rm -f "$(DESTDIR)$(PREFIX)"/$${f##*:}; done
	$(Q)rm -rf $(DESTDIR)$(PREFIX)/share/aebmc $(DESTDIR)$(PREFIX)/lib/aebmc

# A tarball of what is committed, with the packages to carry along to a machine without internet.
DIST := aebmc-$(VERSION)
dist:
	$(Q)mkdir -p $(O)/dist && echo '$(GIT_COMMIT)' >$(O)/dist/.commit
	$(Q){ echo '# Debian packages to build, check and run $(DIST). Where there is internet, in a folder of its own:'; \
	echo "#   apt-get download \$$(grep -v '^#' packages.txt) and what apt-cache depends names; then there: dpkg -i *.deb"; \
	printf '%s\n' $(sort $(DEPS_CHECK) bash-completion); } >$(O)/dist/packages.txt
	$(Q)git archive --format=tar.gz --prefix=$(DIST)/ --add-file=$(O)/dist/.commit \
		--add-file=$(O)/dist/packages.txt -o $(O)/$(DIST).tar.gz HEAD
	$(call say,DIST,$(O)/$(DIST).tar.gz)

# A Debian package of what is committed, in $(O)/deb; its files lie in systemd/debian. WITH_CUDA as above.
.PHONY: deb check-deb
deb: deps-deb dist
	$(Q)WITH_CUDA=$(WITH_CUDA) tools/deb $(O)/$(DIST).tar.gz $(VERSION) $(O)/deb
	$(call say,DEB,$(O)/deb)
check-deb: deps-deb all
	$(Q)O=$(O) tests/run $(RUN_FLAGS) --log $(O)/log tests/deb.sh

format:
	$(Q)clang-format -i $$(find kernels can-dbc daemon tools tests -name '*.[ch]' -o -name '*.cu')

clean:
	rm -rf $(O)

-include $(shell find $(O) -name '*.d' -type f 2>/dev/null)
