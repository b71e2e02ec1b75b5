/* SPDX-License-Identifier: MIT
 * Files below a root, as aebmc doctor reads them: first lines, numbers, lists of processors.
 */
#ifndef AEBMC_DOCTOR_FILE_H
#define AEBMC_DOCTOR_FILE_H

#include <glob.h>
#include <sched.h>
#include <stddef.h>
#include <stdint.h>

#define DOCTOR_LINE_MAX 4096

/** doctor_file_there - 1 if there is such a file or folder. */
int doctor_file_there(const char *root, const char *path);

/** doctor_file_line - the first line that begins with @start (or the first, for ""), without its end. 0 or -errno. */
int doctor_file_line(const char *root, const char *path, const char *start,
		     char line[DOCTOR_LINE_MAX]);

/** doctor_file_holds - 1 if a line holds @part. */
int doctor_file_holds(const char *root, const char *path, const char *part);

/** doctor_file_gz_holds - the same of a file compressed by gzip, which zcat unpacks; waits for it. */
int doctor_file_gz_holds(const char *root, const char *path, const char *part);

/** doctor_file_number - a file that is one number. 0, -errno, or -EINVAL. */
int doctor_file_number(const char *root, const char *path, int64_t *ret);

/** doctor_file_glob - paths below @root that match; paths are returned with it. globfree() in any case. Returns how many. */
size_t doctor_file_glob(const char *root, const char *pattern, glob_t *found);

/** doctor_file_cpus - processors of a list as "2-3,5"; what is no list is empty. Pure. */
cpu_set_t doctor_file_cpus(const char *list);

#endif
