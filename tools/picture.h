/* SPDX-License-Identifier: MIT
 * A picture into a file: SVG as it is drawn, or PNG where the name ends in .png, by the program rsvg-convert.
 */
#ifndef AEBMC_PICTURE_H
#define AEBMC_PICTURE_H

#include <stdio.h>

/**
 * picture_write - draw into @path, "-" is standard output (SVG)
 * @name: "aebmc SUB", for messages
 * Returns 0, or an exit code after one line: CLI_SKIPPED where PNG is wanted and rsvg-convert is missing, which leaves no
 * file behind. Blocks while the other program runs.
 */
int picture_write(const char *name, const char *path, void (*draw)(FILE *out, const void *arg),
		  const void *arg);

#endif
