/* SPDX-License-Identifier: MIT
 * Checks of the machine: kernel, processors, limits, modules, devices. See doctor.def.
 */
#include "doctor.h"
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include "doctor_file.h"
#include "text.h"

/* ---- kernel ------------------------------------------------------------------------------------ */

enum doctor_verdict doctor_rt_kernel(const struct doctor *d, doctor_text is)
{
	char line[DOCTOR_LINE_MAX] = "unknown";
	int64_t real_time = 0;

	doctor_file_number(d->root, "/sys/kernel/realtime", &real_time);
	doctor_file_line(d->root, "/proc/version", "", line);
	if (strstr(line, "PREEMPT_RT")) {
		real_time = 1;
	}
	return doctor_say(is, real_time ? DOCTOR_GOOD : DOCTOR_MISSING, "%s%.80s",
			  real_time ? "" : "not one: ", line);
}

#define RT_GROUP        "CONFIG_RT_GROUP_SCHED"
#define CONFIG_OF_IMAGE "/proc/config.gz"

/* Debian and Ubuntu lay the kernel's configuration beside it; a Jetson's kernel holds it itself. */
static enum doctor_verdict rt_group_in_config(const struct doctor *d, doctor_text is)
{
	char release[DOCTOR_LINE_MAX], path[DOCTOR_LINE_MAX + 32];
	int on;

	if (doctor_file_gz_holds(d->root, CONFIG_OF_IMAGE, RT_GROUP)) {
		on = doctor_file_gz_holds(d->root, CONFIG_OF_IMAGE, RT_GROUP "=y");
		return doctor_say(is, on ? DOCTOR_MISSING : DOCTOR_GOOD, "%s in %s",
				  on ? "on" : "off", CONFIG_OF_IMAGE);
	}
	if (doctor_file_line(d->root, "/proc/sys/kernel/osrelease", "", release)) {
		return doctor_say(is, DOCTOR_NONE, "no /proc");
	}
	snprintf(path, sizeof(path), "/boot/config-%s", release);
	if (!doctor_file_there(d->root, path)) {
		return doctor_say(is, DOCTOR_NONE, "not known: no %.120s, no %s", path,
				  CONFIG_OF_IMAGE);
	}
	on = doctor_file_holds(d->root, path, RT_GROUP "=y");
	return doctor_say(is, on ? DOCTOR_MISSING : DOCTOR_GOOD, "%s in %.120s", on ? "on" : "off",
			  path);
}

enum doctor_verdict doctor_rt_group(const struct doctor *d, doctor_text is)
{
	return doctor_file_there(d->root, "/sys/fs/cgroup/cpu/cpu.rt_runtime_us")
		       ? doctor_say(is, DOCTOR_MISSING, "on")
		       : rt_group_in_config(d, is);
}

enum doctor_verdict doctor_throttling(const struct doctor *d, doctor_text is)
{
	int64_t us;

	if (doctor_file_number(d->root, "/proc/sys/kernel/sched_rt_runtime_us", &us)) {
		return doctor_say(is, DOCTOR_NONE, "not known");
	}
	return doctor_say(is, us < 0 ? DOCTOR_GOOD : DOCTOR_ADVICE, "%lld us a second",
			  (long long)us);
}

/* Loaded, built in, or there to be loaded. */
static int has_module(const struct doctor *d, const char *name)
{
	static const char *const list[] = {"modules.dep", "modules.builtin"};
	char release[DOCTOR_LINE_MAX], path[DOCTOR_LINE_MAX + 64], file[64];
	int found = 0;

	snprintf(path, sizeof(path), "/sys/module/%s", name);
	if (doctor_file_there(d->root, path)) {
		return 1;
	}
	if (doctor_file_line(d->root, "/proc/sys/kernel/osrelease", "", release)) {
		return 0;
	}
	snprintf(file, sizeof(file), "/%s.ko", name);
	for (char *c = file; *c; c++) {
		*c = *c == '_' ? '-' : *c;
	}
	for (size_t i = 0; i < sizeof(list) / sizeof(list[0]); i++) {
		snprintf(path, sizeof(path), "/lib/modules/%s/%s", release, list[i]);
		found |= doctor_file_holds(d->root, path, file);
	}
	return found;
}

static enum doctor_verdict module(const struct doctor *d, const char *name,
				  enum doctor_verdict without, doctor_text is)
{
	const int found = has_module(d, name);

	return doctor_say(is, found ? DOCTOR_GOOD : without, "%s",
			  found ? "there" : "not part of this kernel");
}

enum doctor_verdict doctor_can(const struct doctor *d, doctor_text is)
{
	if (doctor_file_there(d->root, "/proc/net/can")) {
		return doctor_say(is, DOCTOR_GOOD, "there");
	}
	return module(d, "can_raw", DOCTOR_MISSING, is);
}

enum doctor_verdict doctor_vcan(const struct doctor *d, doctor_text is)
{
	return module(d, "vcan", DOCTOR_ADVICE, is);
}

enum doctor_verdict doctor_can_gw(const struct doctor *d, doctor_text is)
{
	return module(d, "can_gw", DOCTOR_ADVICE, is);
}

/* ---- limits: of the daemon, of its unit, of this process --------------------------------------------- */

static const char *const unit_dir[] = {"/etc/systemd/system", "/usr/local/lib/systemd/system",
				       "/usr/lib/systemd/system", "/lib/systemd/system"};

static int daemon_limits(const struct doctor *d, char path[DOCTOR_LINE_MAX])
{
	glob_t found;
	char name[DOCTOR_LINE_MAX];
	const size_t n = doctor_file_glob(d->root, "/proc/[0-9]*/comm", &found);
	int ret = 0;

	for (size_t i = 0; i < n && !ret; i++) {
		if (!doctor_file_line("", found.gl_pathv[i], "", name) && !strcmp(name, "aebmcd")) {
			snprintf(path, DOCTOR_LINE_MAX, "%.*s/limits",
				 (int)(strlen(found.gl_pathv[i]) - strlen("/comm")),
				 found.gl_pathv[i]);
			ret = 1;
		}
	}
	globfree(&found);
	return ret;
}

static int unit_limit(const struct doctor *d, const char *key, char line[DOCTOR_LINE_MAX])
{
	char path[DOCTOR_LINE_MAX];

	for (size_t i = 0; i < sizeof(unit_dir) / sizeof(unit_dir[0]); i++) {
		snprintf(path, sizeof(path), "%s/aebmcd@.service", unit_dir[i]);
		if (!doctor_file_line(d->root, path, key, line)) {
			return 1;
		}
	}
	return 0;
}

/* The soft limit in words, and whose it is. */
static const char *limit(const struct doctor *d, const char *name, const char *key,
			 char value[DOCTOR_LINE_MAX])
{
	char path[DOCTOR_LINE_MAX], line[DOCTOR_LINE_MAX];
	const char *whose = "of aebmcd as it runs";

	if (!daemon_limits(d, path)) {
		if (unit_limit(d, key, line)) {
			snprintf(value, DOCTOR_LINE_MAX, "%s", line + strlen(key));
			return "in aebmcd@.service";
		}
		snprintf(path, sizeof(path), "%s/proc/self/limits", d->root);
		whose = "of this shell";
	}
	if (doctor_file_line("", path, name, line) ||
	    sscanf(line + strlen(name), "%4095s", value) != 1) {
		snprintf(value, DOCTOR_LINE_MAX, "not known");
	}
	return whose;
}

enum doctor_verdict doctor_memlock(const struct doctor *d, doctor_text is)
{
	char value[DOCTOR_LINE_MAX];
	const char *whose = limit(d, "Max locked memory", "LimitMEMLOCK=", value);
	const int good = !strcmp(value, "unlimited") || !strcmp(value, "infinity");

	return doctor_say(is, good ? DOCTOR_GOOD : DOCTOR_MISSING, "%.40s, %s", value, whose);
}

enum doctor_verdict doctor_rtprio(const struct doctor *d, doctor_text is)
{
	char value[DOCTOR_LINE_MAX];
	const char *whose = limit(d, "Max realtime priority", "LimitRTPRIO=", value);
	int64_t priority = 0;
	const int good = !strcmp(value, "unlimited") || !strcmp(value, "infinity") ||
			 (!text_integer(value, &priority) && priority >= d->cfg->rt_priority);

	return doctor_say(is, good ? DOCTOR_GOOD : DOCTOR_MISSING, "%.40s, %s", value, whose);
}

/* ---- devices and libraries ------------------------------------------------------------------------- */

enum doctor_verdict doctor_latency(const struct doctor *d, doctor_text is)
{
	char path[DOCTOR_LINE_MAX], group[DOCTOR_LINE_MAX];
	struct stat st;
	const mode_t both = S_IRGRP | S_IWGRP;
	unsigned long id = ULONG_MAX;

	snprintf(path, sizeof(path), "%s/dev/cpu_dma_latency", d->root);
	if (stat(path, &st)) {
		return doctor_say(is, DOCTOR_MISSING, "not there");
	}
	if (!doctor_file_line(d->root, "/etc/group", "aebmc:", group)) {
		sscanf(group, "aebmc:%*[^:]:%lu", &id);
	}
	const int good = st.st_gid == id && (st.st_mode & both) == both;

	return doctor_say(is, good ? DOCTOR_GOOD : DOCTOR_MISSING, "mode %04o, %s group aebmc",
			  st.st_mode & 07777, st.st_gid == id ? "of" : "not of");
}

enum doctor_verdict doctor_lttng(const struct doctor *d, doctor_text is)
{
	glob_t found;
	const size_t libs = doctor_file_glob(d->root, "/usr/lib/*/liblttng-ust.so.*", &found);

	globfree(&found);
	if (!libs || !doctor_file_there(d->root, "/usr/bin/lttng")) {
		return doctor_say(is, DOCTOR_ADVICE, "%s",
				  libs ? "no /usr/bin/lttng" : "no liblttng-ust");
	}
	return doctor_say(is, DOCTOR_GOOD, "there");
}

enum doctor_verdict doctor_cuda(const struct doctor *d, doctor_text is)
{
	static const char *const device[] = {"/dev/nvidiactl", "/dev/nvhost-gpu", "/dev/nvgpu"};
	enum { BACKEND_CUDA = 2 }; /* of mc.backend */

	for (size_t i = 0; i < sizeof(device) / sizeof(device[0]); i++) {
		if (doctor_file_there(d->root, device[i])) {
			return doctor_say(is, DOCTOR_GOOD, "%s", device[i]);
		}
	}
	return d->cfg->mc_backend == BACKEND_CUDA
		       ? doctor_say(is, DOCTOR_MISSING, "none, and mc.backend = cuda")
		       : doctor_say(is, DOCTOR_ADVICE, "none: the CPU computes");
}
