/* SPDX-License-Identifier: MIT
 * For tests of the configuration: files in a directory of their own.
 */
#ifndef AEBMC_TEST_CONF_DIR_H
#define AEBMC_TEST_CONF_DIR_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CONF_DIR_PATH 256

/* conf_dir_open - a new directory into @dir */
static inline void conf_dir_open(char dir[CONF_DIR_PATH])
{
	snprintf(dir, CONF_DIR_PATH, "/tmp/aebmc-test-XXXXXX");
	assert_non_null(mkdtemp(dir));
}

/* conf_dir_write - @len bytes to a file in @dir, its path into @path */
static inline void conf_dir_write(const char *dir, const char *name, const void *text, size_t len,
				  char path[2 * CONF_DIR_PATH])
{
	FILE *f;

	snprintf(path, 2 * CONF_DIR_PATH, "%s/%s", dir, name);
	unlink(path); /* rewriting in place waits for the disk on some file systems */
	f = fopen(path, "w");
	assert_non_null(f);
	assert_int_equal(fwrite(text, 1, len, f), len);
	assert_int_equal(fclose(f), 0);
}

/* conf_dir_read - a whole file, at most @size - 1 bytes, 0-terminated. Returns its length. */
static inline size_t conf_dir_read(const char *path, char *text, size_t size)
{
	FILE *f = fopen(path, "r");
	size_t n;

	assert_non_null(f);
	n = fread(text, 1, size - 1, f);
	text[n] = '\0';
	fclose(f);
	assert_true(n < size - 1);
	return n;
}

static inline void conf_dir_close(const char *dir)
{
	char path[CONF_DIR_PATH + 256 + 1];
	DIR *d = opendir(dir);
	struct dirent *e;

	while (d && (e = readdir(d))) {
		snprintf(path, sizeof(path), "%s/%s", dir, e->d_name);
		unlink(path);
	}
	closedir(d);
	rmdir(dir);
}

#endif
