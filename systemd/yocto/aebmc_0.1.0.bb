# SPDX-License-Identifier: MIT
# UNTESTED: written from the manuals of Yocto and meta-tegra, never baked. Into a layer of your own as
# recipes-automotive/aebmc/aebmc_0.1.0.bb; the tarball of `make dist` goes beside it into files/.
#
# LAYERDEPENDS: core, openembedded-layer (libsocketcan), tegra (CUDA for Jetson Orin, sm_87).
# kas or local.conf: MACHINE = "jetson-agx-orin-devkit" or "jetson-orin-nano-devkit", PACKAGECONFIG:append = " cuda" where
# meta-tegra's CUDA is wanted, IMAGE_INSTALL:append = " aebmc".
SUMMARY = "Collision risk for automatic emergency braking, by Monte Carlo"
DESCRIPTION = "A real-time daemon between CAN inputs and a brake request, and a tool around it. Research software."
SECTION = "utils"
LICENSE = "MIT"
# md5sum LICENSE
LIC_FILES_CHKSUM = "file://LICENSE;md5=8b7af3a756f2b58c638e737be48e0595"

SRC_URI = "file://aebmc-${PV}.tar.gz"
S = "${WORKDIR}/aebmc-${PV}"

DEPENDS = "systemd libsocketcan"
PACKAGECONFIG ??= ""
# nvcc runs on the build machine; meta-tegra's class brings it and the runtime for the target.
PACKAGECONFIG[cuda] = ",,cuda-cudart cuda-nvcc-native,"

inherit systemd useradd pkgconfig ${@bb.utils.contains('PACKAGECONFIG', 'cuda', 'cuda', '', d)}

# The Makefile takes the compiler's name for the processor (dumpmachine) and finds optional libraries by their headers.
EXTRA_OEMAKE = "PREFIX=${prefix} CC='${CC}' CROSS=${TARGET_PREFIX} WITH_SYSTEMD=yes WITH_SOCKETCAN=yes WITH_LTTNG=no \
    LDFLAGS='${LDFLAGS}' CFLAGS='${CFLAGS}' ${CUDA_OEMAKE}"
CUDA_OEMAKE = "${@bb.utils.contains('PACKAGECONFIG', 'cuda', \
    'WITH_CUDA=yes CUDA_CCBIN=${CUDAHOSTCXX} CUDA_LIB=${STAGING_DIR_TARGET}/usr/local/cuda-${CUDA_VERSION}/lib', 'WITH_CUDA=no', d)}"

do_compile() {
    oe_runmake all
}

# No man pages: the daemon prints their options, and it does not run on the build machine.
do_install() {
    oe_runmake install DESTDIR=${D}
}

# Nothing is enabled: which configuration a car has is for its owner to say (systemctl enable aebmcd@car).
SYSTEMD_SERVICE:${PN} = "aebmcd@.service aebmc-irq.service aebmc-clocks.service"
SYSTEMD_AUTO_ENABLE = "disable"

USERADD_PACKAGES = "${PN}"
GROUPADD_PARAM:${PN} = "--system aebmc"
USERADD_PARAM:${PN} = "--system --no-create-home --home-dir /var/lib/aebmc --shell /sbin/nologin --gid aebmc aebmc"

FILES:${PN} += "${prefix}/lib/systemd/system ${prefix}/lib/sysusers.d ${prefix}/lib/tmpfiles.d ${prefix}/lib/udev \
    ${datadir}/aebmc ${datadir}/bash-completion"
RDEPENDS:${PN} = "iproute2 can-utils kernel-module-can-raw"
