/* SPDX-License-Identifier: MIT
 * Checks of the processors: isolation, interrupts, clocks. See doctor.def.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "doctor.h"
#include "doctor_file.h"

/* ---- isolation --------------------------------------------------------------------------------- */

static cpu_set_t cpus_of_file(const struct doctor *d, const char *path, char line[DOCTOR_LINE_MAX])
{
	if (doctor_file_line(d->root, path, "", line) || !line[0] || line[0] == '(') {
		snprintf(line, DOCTOR_LINE_MAX, "none");
	}
	return doctor_file_cpus(line);
}

/* The list after @key on the kernel's command line; its words may be followed by flags, as in "managed_irq,2-3". */
static cpu_set_t cpus_of_cmdline(const struct doctor *d, const char *key,
				 char list[DOCTOR_LINE_MAX])
{
	char line[DOCTOR_LINE_MAX];
	const char *at =
		doctor_file_line(d->root, "/proc/cmdline", "", line) ? NULL : strstr(line, key);

	snprintf(list, DOCTOR_LINE_MAX, "none");
	if (at) {
		at += strlen(key);
		snprintf(list, DOCTOR_LINE_MAX, "%.*s", (int)strcspn(at, " "), at);
	}
	return doctor_file_cpus(list);
}

static int overlap(const cpu_set_t *a, const cpu_set_t *b)
{
	cpu_set_t both;

	CPU_AND(&both, a, b);
	return CPU_COUNT(&both);
}

void doctor_isolated_read(struct doctor *d)
{
	char line[DOCTOR_LINE_MAX];

	d->isolated = cpus_of_file(d, "/sys/devices/system/cpu/isolated", line);
}

/* A processor that the configuration asks for and that is not isolated; -1 if there is none. */
static int64_t not_isolated(const struct doctor *d)
{
	const int64_t wanted[] = {d->cfg->rt_cpu, d->cfg->rt_compute_cpu};

	for (int i = 0; i < 2; i++) {
		if (wanted[i] >= 0 && !CPU_ISSET((size_t)wanted[i], &d->isolated)) {
			return wanted[i];
		}
	}
	return -1;
}

enum doctor_verdict doctor_isolated(const struct doctor *d, doctor_text is)
{
	char line[DOCTOR_LINE_MAX];
	const int64_t cpu = not_isolated(d);

	cpus_of_file(d, "/sys/devices/system/cpu/isolated", line);
	if (cpu >= 0) {
		return doctor_say(is, DOCTOR_ADVICE, "%.60s; the configuration wants %lld", line,
				  (long long)cpu);
	}
	return doctor_say(is, CPU_COUNT(&d->isolated) ? DOCTOR_GOOD : DOCTOR_ADVICE, "%.60s", line);
}

/* Are all isolated processors in @set? */
static enum doctor_verdict covers(const struct doctor *d, const cpu_set_t *set, const char *words,
				  doctor_text is)
{
	const int isolated = CPU_COUNT(&d->isolated);

	if (!isolated) {
		return doctor_say(is, DOCTOR_NONE, "%.60s; no isolated processors", words);
	}
	return doctor_say(is, overlap(set, &d->isolated) == isolated ? DOCTOR_GOOD : DOCTOR_ADVICE,
			  "%.60s", words);
}

enum doctor_verdict doctor_nohz_full(const struct doctor *d, doctor_text is)
{
	char line[DOCTOR_LINE_MAX];
	const cpu_set_t set = cpus_of_file(d, "/sys/devices/system/cpu/nohz_full", line);

	return covers(d, &set, line, is);
}

enum doctor_verdict doctor_rcu_nocbs(const struct doctor *d, doctor_text is)
{
	char list[DOCTOR_LINE_MAX];
	const cpu_set_t set = cpus_of_cmdline(d, "rcu_nocbs=", list);

	return covers(d, &set, list, is);
}

/* Does @set keep off the isolated processors? */
static enum doctor_verdict keeps_off(const struct doctor *d, const cpu_set_t *set,
				     const char *words, doctor_text is)
{
	if (!CPU_COUNT(&d->isolated)) {
		return doctor_say(is, DOCTOR_NONE, "%.60s; no isolated processors", words);
	}
	return doctor_say(
		is, CPU_COUNT(set) && !overlap(set, &d->isolated) ? DOCTOR_GOOD : DOCTOR_ADVICE,
		"%.60s", words);
}

enum doctor_verdict doctor_irq_affinity(const struct doctor *d, doctor_text is)
{
	char list[DOCTOR_LINE_MAX];
	const cpu_set_t set = cpus_of_cmdline(d, "irqaffinity=", list);

	return keeps_off(d, &set, list, is);
}

enum doctor_verdict doctor_cpuset(const struct doctor *d, doctor_text is)
{
	char line[DOCTOR_LINE_MAX];
	const cpu_set_t set =
		cpus_of_file(d, "/sys/fs/cgroup/system.slice/cpuset.cpus.effective", line);

	return keeps_off(d, &set, line, is);
}

/* ---- CAN interrupts ---------------------------------------------------------------------------- */

/* Fields 40 and 41 of proc(5) stat; the name in field 2 may hold blanks. SCHED_FIFO is 1. 0: not a FIFO thread. */
static int fifo_priority(const char *stat)
{
	const char *p = strrchr(stat, ')');
	int priority = 0, policy = 0;

	for (int field = 2; p && field < 40; field++) {
		p = strchr(p + 1, ' ');
	}
	return p && sscanf(p, "%d %d", &priority, &policy) == 2 && policy == 1 ? priority : 0;
}

static int is_can_irq(const char *comm)
{
	return !strncmp(comm, "irq/", 4) && (strstr(comm, "can") || strstr(comm, "mcp25"));
}

/* The lowest priority of all CAN interrupt threads, and whose; -1 without any. */
static int lowest_irq(const struct doctor *d, char name[DOCTOR_LINE_MAX])
{
	glob_t found;
	char comm[DOCTOR_LINE_MAX], stat[DOCTOR_LINE_MAX];
	const size_t n = doctor_file_glob(d->root, "/proc/[0-9]*/comm", &found);
	int lowest = -1;

	for (size_t i = 0; i < n; i++) {
		char *path = found.gl_pathv[i];

		if (doctor_file_line("", path, "", comm) || !is_can_irq(comm)) {
			continue;
		}
		strcpy(strrchr(path, '/'), "/stat"); /* as long as "/comm" */
		if (!doctor_file_line("", path, "", stat) &&
		    (lowest < 0 || fifo_priority(stat) < lowest)) {
			lowest = fifo_priority(stat);
			strcpy(name, comm);
		}
	}
	globfree(&found);
	return lowest;
}

enum doctor_verdict doctor_can_irq(const struct doctor *d, doctor_text is)
{
	char name[DOCTOR_LINE_MAX];
	const int priority = lowest_irq(d, name);

	if (priority < 0) {
		return doctor_say(is, DOCTOR_NONE, "no CAN interrupt thread");
	}
	return doctor_say(is,
			  priority > d->cfg->rt_compute_priority && priority < d->cfg->rt_priority
				  ? DOCTOR_GOOD
				  : DOCTOR_ADVICE,
			  "%.40s: FIFO %d", name, priority);
}

/* ---- clocks ------------------------------------------------------------------------------------ */

enum doctor_verdict doctor_governor(const struct doctor *d, doctor_text is)
{
	glob_t found;
	char line[DOCTOR_LINE_MAX] = "";
	const size_t n = doctor_file_glob(
		d->root, "/sys/devices/system/cpu/cpu[0-9]*/cpufreq/scaling_governor", &found);
	size_t good = 0;

	while (good < n && !doctor_file_line("", found.gl_pathv[good], "", line) &&
	       !strcmp(line, "performance")) {
		good++;
	}
	globfree(&found);
	if (!n) {
		return doctor_say(is, DOCTOR_NONE, "this kernel does not change clocks");
	}
	return doctor_say(is, good == n ? DOCTOR_GOOD : DOCTOR_ADVICE, "%.40s", line);
}

static int is_jetson(const struct doctor *d)
{
	return doctor_file_there(d->root, "/etc/nv_tegra_release") ||
	       doctor_file_holds(d->root, "/proc/device-tree/compatible", "nvidia,tegra");
}

/* "pmode:0000"; on an Orin Nano with MAXN_SUPER that is mode 2. */
enum doctor_verdict doctor_jetson_power(const struct doctor *d, doctor_text is)
{
	char line[DOCTOR_LINE_MAX];

	if (!is_jetson(d)) {
		return doctor_say(is, DOCTOR_NONE, "not a Jetson");
	}
	if (doctor_file_line(d->root, "/var/lib/nvpmodel/status", "pmode:", line)) {
		return doctor_say(is, DOCTOR_ADVICE, "no power mode was set");
	}
	const long mode = strtol(line + strlen("pmode:"), NULL, 10);

	return doctor_say(is, mode == 0 ? DOCTOR_GOOD : DOCTOR_ADVICE, "mode %ld", mode);
}

enum doctor_verdict doctor_jetson_clocks(const struct doctor *d, doctor_text is)
{
	glob_t found;
	char low[DOCTOR_LINE_MAX] = "?", high[DOCTOR_LINE_MAX] = "??";

	if (!is_jetson(d)) {
		return doctor_say(is, DOCTOR_NONE, "not a Jetson");
	}
	if (doctor_file_glob(d->root, "/sys/class/devfreq/*.gpu", &found)) {
		doctor_file_line(found.gl_pathv[0], "/min_freq", "", low);
		doctor_file_line(found.gl_pathv[0], "/max_freq", "", high);
	}
	globfree(&found);
	return doctor_say(is, strcmp(low, high) ? DOCTOR_ADVICE : DOCTOR_GOOD,
			  "GPU %.20s to %.20s Hz", low, high);
}

enum doctor_verdict doctor_jetson_memory(const struct doctor *d, doctor_text is)
{
	static const char emc[] = "/sys/kernel/debug/bpmp/debug/clk/emc";
	char dir[DOCTOR_LINE_MAX], rate[DOCTOR_LINE_MAX], max[DOCTOR_LINE_MAX];

	if (!is_jetson(d)) {
		return doctor_say(is, DOCTOR_NONE, "not a Jetson");
	}
	snprintf(dir, sizeof(dir), "%s%s", d->root, emc);
	if (doctor_file_line(dir, "/rate", "", rate) ||
	    doctor_file_line(dir, "/max_rate", "", max)) {
		return doctor_say(is, DOCTOR_NONE, "not readable: ask as root");
	}
	return doctor_say(is, strcmp(rate, max) ? DOCTOR_ADVICE : DOCTOR_GOOD, "%.20s of %.20s Hz",
			  rate, max);
}
