/* SPDX-License-Identifier: MIT
 * DBC text to struct dbc: the file, its statements (a table), and what can only be checked at its end.
 */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "codec.h"
#include "loader.h"

static void free_message(const struct dbc_message *m)
{
	for (uint32_t i = 0; i < m->n_signals; i++) {
		free((void *)m->signals[i].values);
	}
	free((void *)m->signals);
}

/* ---- statements -------------------------------------------------------------------------------- */

static void skip_statement(struct loader *ld, const char *word)
{
	lex_skip(&ld->lx, word);
}

static void skip_line(struct loader *ld, const char *word)
{
	(void)word;
	lex_skip_line(&ld->lx);
}

static void skip_string(struct loader *ld, const char *word)
{
	lex_string(&ld->lx, word);
}

/* NS_ lists the names of statements: up to the one that must follow it. */
static void skip_symbols(struct loader *ld, const char *word)
{
	struct lex *lx = &ld->lx;
	lex_expect(lx, ':', word);
	while (lex_is_word(lx)) {
		struct lex before = *lx;
		const char *symbol = lex_word(lx, word);
		if (!strcmp(symbol, "BS_") || !strcmp(symbol, "BU_") || !strcmp(symbol, "BO_")) {
			*lx = before;
			return;
		}
	}
}

static void refuse(struct loader *ld, const char *word)
{
	lex_fail(&ld->lx, -ENOTSUP, "%s is not supported: remove what it describes", word);
}

static const struct {
	const char *word;
	void (*read)(struct loader *ld, const char *word);
} statements[] = {
	{"VERSION", skip_string},
	{"NS_", skip_symbols},
	{"BS_", skip_line},
	{"BU_", skip_line},
	{"BO_", loader_message},
	{"SG_", loader_signal},
	{"VAL_", loader_values},
	{"SIG_VALTYPE_", loader_value_type},
	{"BA_DEF_", loader_attr_definition},
	{"BA_DEF_DEF_", loader_attr_default},
	{"BA_", loader_attr},
	{"CM_", skip_statement},
	{"VAL_TABLE_", skip_statement},
	{"BO_TX_BU_", skip_statement},
	{"SIG_GROUP_", skip_statement},
	{"EV_", skip_statement},
	{"EV_DATA_", skip_statement},
	{"ENVVAR_DATA_", skip_statement},
	{"BA_DEF_REL_", skip_statement},
	{"BA_REL_", skip_statement},
	{"BA_DEF_DEF_REL_", skip_statement},
	{"BU_SG_REL_", skip_statement},
	{"BU_EV_REL_", skip_statement},
	{"BU_BO_REL_", skip_statement},
	{"CAT_DEF_", skip_statement},
	{"CAT_", skip_statement},
	{"FILTER", skip_statement},
	{"SG_MUL_VAL_", refuse},
	{"SGTYPE_", refuse},
	{"SGTYPE_VAL_", refuse},
	{"BA_DEF_SGTYPE_", refuse},
	{"BA_SGTYPE_", refuse},
	{"SIG_TYPE_REF_", refuse},
	{"SIGTYPE_VALTYPE_", refuse},
};

static void read_statement(struct loader *ld)
{
	const char *word = lex_word(&ld->lx, "DBC statement");
	for (size_t i = 0; i < sizeof(statements) / sizeof(statements[0]); i++) {
		if (!strcmp(word, statements[i].word)) {
			statements[i].read(ld, statements[i].word);
			return;
		}
	}
	lex_fail(&ld->lx, -EINVAL, "'%.40s' is no DBC statement", word);
}

/* ---- the end of the file ----------------------------------------------------------------------- */

static void check_mux(struct loader *ld, const struct dbc_message *m)
{
	for (uint32_t i = 0; i < m->n_signals; i++) {
		const struct dbc_signal *s = &m->signals[i];
		if (s->mux != DBC_MULTIPLEXED) {
			continue;
		}
		if (!m->mux) {
			lex_fail(&ld->lx, -EINVAL,
				 "message %s: signal %s is multiplexed, but no signal is marked M",
				 m->name, s->name);
		} else if (s->mux_value > codec_mask(m->mux)) {
			lex_fail(&ld->lx, -EINVAL,
				 "message %s: multiplexor %s never takes the m%u of signal %s",
				 m->name, m->mux->name, s->mux_value, s->name);
		}
	}
}

static void drop_orphans(struct loader *ld)
{
	const struct dbc_message *m = dbc_find_id(ld->dbc, LOADER_ID_ORPHANS);
	if (m) {
		size_t at = (size_t)(m - ld->messages);
		free_message(m);
		ld->dbc->n_messages--;
		memmove(&ld->messages[at], &ld->messages[at + 1],
			(ld->dbc->n_messages - at) * sizeof(*m));
	}
}

static void finish(struct loader *ld)
{
	for (uint32_t i = 0; i < ld->dbc->n_messages && !ld->lx.rc; i++) {
		loader_attr_apply(ld, i);
		ld->lx.line = ld->notes[i].line;
		check_mux(ld, &ld->messages[i]);
	}
	drop_orphans(ld);
	if (!ld->dbc->n_messages) {
		ld->lx.line = 0;
		lex_fail(&ld->lx, -EINVAL, "no message (BO_) in it: is this a DBC file?");
	}
}

/* ---- the file ---------------------------------------------------------------------------------- */

/* NUL would hide the rest of the text; no tool writes lines of DBC_LINE_MAX. */
static void check_text(struct lex *lx, const char *text, size_t len)
{
	const char *nul = memchr(text, 0, len);
	const char *end = nul ? nul : text + len;
	lx->line = 1;
	for (const char *p = text; p < end; lx->line++) {
		const char *newline = memchr(p, '\n', (size_t)(end - p));
		size_t n = (size_t)((newline ? newline : end) - p);
		if (n > DBC_LINE_MAX) {
			lex_fail(lx, -EINVAL,
				 "line of %zu characters, at most %u are read: is this a DBC file?",
				 n, DBC_LINE_MAX);
			return;
		}
		if (nul && !newline) {
			break;
		}
		p += n + 1;
	}
	if (nul) {
		lex_fail(lx, -EINVAL, "NUL character: is this a DBC file?");
	}
}

static void parse(struct loader *ld, const char *text)
{
	static const char bom[] = "\xEF\xBB\xBF";
	struct lex *lx = &ld->lx;
	lx->p = strncmp(text, bom, sizeof(bom) - 1) ? text : text + sizeof(bom) - 1;
	lx->pool = ld->dbc->names;
	lx->line = 1;
	while (lex_peek(lx)) {
		read_statement(ld);
	}
	if (!lx->rc) {
		finish(ld);
	}
}

int dbc_parse(const char *name, const char *text, size_t len, struct dbc **ret, char *err,
	      size_t err_size)
{
	struct lex lx = {.name = name, .err = err, .err_size = err_size};
	check_text(&lx, text, len);
	if (lx.rc) {
		return lx.rc;
	}
	lx.line = 0;
	struct loader *ld = calloc(1, sizeof(*ld));
	struct dbc *dbc = calloc(1, sizeof(*dbc));
	char *copy = malloc(len + 1);
	char *names = malloc(len + 1);
	if (ld && dbc && copy && names) {
		memcpy(copy, text, len);
		copy[len] = 0;
		dbc->names = names;
		ld->lx = lx;
		ld->dbc = dbc;
		parse(ld, copy);
		lx.rc = ld->lx.rc;
		free(ld->notes);
	} else {
		lex_fail(&lx, -ENOMEM, "out of memory");
		free(names);
	}
	free(copy);
	free(ld);
	if (lx.rc) {
		dbc_free(dbc);
		return lx.rc;
	}
	*ret = dbc;
	return 0;
}

void dbc_free(struct dbc *dbc)
{
	if (!dbc) {
		return;
	}
	for (uint32_t i = 0; i < dbc->n_messages; i++) {
		free_message(&dbc->messages[i]);
	}
	free((void *)dbc->messages);
	free(dbc->names);
	free(dbc);
}

/* Opens a regular file; never waits for a pipe's other end. Descriptor or -errno. */
static int open_regular(const char *path, struct stat *st)
{
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	int rc = fd < 0 || fstat(fd, st) < 0  ? -errno
		 : S_ISDIR(st->st_mode)       ? -EISDIR
		 : !S_ISREG(st->st_mode)      ? -EINVAL
		 : st->st_size > DBC_FILE_MAX ? -EFBIG
					      : fd;
	if (rc < 0 && fd >= 0) {
		close(fd);
	}
	return rc;
}

/* Bytes read, fewer than @size only at the end of the file, or -errno. */
static ssize_t read_all(int fd, char *text, size_t size)
{
	size_t n = 0;
	ssize_t got;
	while ((got = read(fd, text + n, size - n)) > 0) {
		n += (size_t)got;
	}
	return got < 0 ? -errno : (ssize_t)n;
}

static int fail_file(const char *path, int rc, char *err, size_t err_size)
{
	struct lex lx = {.name = path, .err = err, .err_size = err_size};
	lex_fail(&lx, rc, "%s",
		 rc == -EFBIG    ? "larger than 16 MiB: is this a DBC file?"
		 : rc == -EINVAL ? "not a regular file"
				 : strerror(-rc));
	return rc;
}

int dbc_load(const char *path, struct dbc **ret, char *err, size_t err_size)
{
	struct stat st;
	int fd = open_regular(path, &st);
	if (fd < 0) {
		return fail_file(path, fd, err, err_size);
	}
	char *text = malloc((size_t)st.st_size + 1);
	ssize_t n = text ? read_all(fd, text, (size_t)st.st_size) : -ENOMEM;
	close(fd);
	int rc = n < 0 ? fail_file(path, (int)n, err, err_size)
		       : dbc_parse(path, text, (size_t)n, ret, err, err_size);
	free(text);
	return rc;
}
