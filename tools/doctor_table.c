/* SPDX-License-Identifier: MIT
 * The tables that doctor.def makes.
 */
#include <stdarg.h>
#include <stdio.h>
#include "doctor.h"

/* What mends four of the rows. */
#define COMMAND_LINE                                                                               \
	"cp /usr/share/aebmc/rt-config/60-aebmc.cfg /etc/default/grub.d/ && update-grub (Jetson, " \
	"untested: its words to APPEND in /boot/extlinux/extlinux.conf), then reboot"

#define BUS(name, should, mend)
#define MACHINE(name, should, mend) {#name, should, mend},
const struct doctor_row doctor_machine_row[DOCTOR_MACHINE_ROWS] = {
#include "doctor.def"
};
#undef MACHINE
#define MACHINE(name, should, mend) doctor_##name,
static enum doctor_verdict (*const machine[])(const struct doctor *d, doctor_text is) = {
#include "doctor.def"
};
#undef MACHINE
#undef BUS

#define MACHINE(name, should, mend)
#define BUS(name, should, mend) {#name, should, mend},
const struct doctor_row doctor_bus_row[DOCTOR_BUS_ROWS] = {
#include "doctor.def"
};
#undef BUS
#define BUS(name, should, mend) doctor_bus_##name,
static enum doctor_verdict (*const bus[])(const struct doctor_bus *b, doctor_text is) = {
#include "doctor.def"
};
#undef BUS
#undef MACHINE

enum doctor_verdict doctor_machine(const struct doctor *d, int i, doctor_text is)
{
	return machine[i](d, is);
}

enum doctor_verdict doctor_bus_check(const struct doctor_bus *b, int i, doctor_text is)
{
	return bus[i](b, is);
}

enum doctor_verdict doctor_say(doctor_text is, enum doctor_verdict verdict, const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	vsnprintf(is, DOCTOR_TEXT_MAX, fmt, ap);
	va_end(ap);
	return verdict;
}
