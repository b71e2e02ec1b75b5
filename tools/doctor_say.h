/* SPDX-License-Identifier: MIT
 * How a check of aebmc doctor ends: words and a verdict.
 */
#ifndef AEBMC_DOCTOR_SAY_H
#define AEBMC_DOCTOR_SAY_H

#include "doctor.h"

/** doctor_say - print what is into @is; returns @verdict. */
enum doctor_verdict doctor_say(doctor_text is, enum doctor_verdict verdict, const char *fmt, ...)
	__attribute__((format(printf, 3, 4)));

#endif
