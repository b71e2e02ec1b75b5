/* SPDX-License-Identifier: MIT
 * What names and units of signals say about their role.
 */
#include "mapper.h"
#include <ctype.h>
#include <string.h>
#include <strings.h>

#define TOKENS_MAX 24
#define TOKEN_MAX  (DBC_NAME_MAX + 1)
#define INNER_MIN  5 /* letters of a word that may also stand within a token */
#define EXACT_MAX  2 /* of one that must be the whole token */

const struct mapper_role_row mapper_role_table[MAPPER_ROLES] = {
#define MAPPER_ROLE(name, unit, whose, required, doc) {#name, unit, MAPPER_##whose, required, doc},
#include "mapper.def"
};

static const struct {
	enum mapper_role role;
	enum mapper_where where;
	double points;
	const char *words;
} rows[] = {
#define MAPPER_WORDS(role, where, points, words) {MAPPER_##role, MAPPER_##where, points, words},
#include "mapper.def"
};

struct tokens {
	int n;
	char at[TOKENS_MAX][TOKEN_MAX];
};

/* "ACC_ObjRelSpd" to acc, obj, rel, spd. */
static void split(const char *name, struct tokens *t)
{
	size_t len = 0;

	t->n = 0;
	for (const char *p = name; *p && t->n < TOKENS_MAX; p++) {
		const int begins =
			p > name && isupper((unsigned char)*p) && islower((unsigned char)p[-1]);

		if (len && (begins || !isalnum((unsigned char)*p))) {
			t->at[t->n++][len] = '\0';
			len = 0;
		}
		if (isalnum((unsigned char)*p) && t->n < TOKENS_MAX && len < TOKEN_MAX - 1) {
			t->at[t->n][len++] = (char)tolower((unsigned char)*p);
		}
	}
	if (len && t->n < TOKENS_MAX) {
		t->at[t->n++][len] = '\0';
	}
}

static int is_word(const char *token, const char *word, size_t len)
{
	char copy[32];

	if (!strncmp(token, word, len)) {
		return len > EXACT_MAX || !token[len];
	}
	if (len < INNER_MIN || len >= sizeof(copy)) {
		return 0;
	}
	memcpy(copy, word, len);
	copy[len] = '\0';
	return strstr(token, copy) != NULL;
}

static int has_word(const struct tokens *t, const char *words)
{
	while (*words) {
		const size_t len = strcspn(words, " ");

		for (int i = 0; i < t->n; i++) {
			if (is_word(t->at[i], words, len)) {
				return 1;
			}
		}
		words += len + (words[len] == ' ');
	}
	return 0;
}

double mapper_words(enum mapper_role role, enum mapper_where where, const char *name)
{
	struct tokens t;
	double points = 0;

	split(name, &t);
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		if (rows[i].role == role && rows[i].where == where && has_word(&t, rows[i].words)) {
			points += rows[i].points;
		}
	}
	return points;
}

int mapper_is_counter(const char *name)
{
	struct tokens t;

	split(name, &t);
	return has_word(&t, "cnt count ctr alive rolling zaehler seq bz");
}

const char *mapper_unit(enum unit_kind kind, const char *name)
{
	static const struct {
		enum unit_kind kind;
		const char *spelt, *known;
	} units[] = {
		{UNIT_SPEED, "m/s", "m/s"},
		{UNIT_SPEED, "m/sec", "m/s"},
		{UNIT_SPEED, "mps", "m/s"},
		{UNIT_SPEED, "km/h", "km/h"},
		{UNIT_SPEED, "km/hr", "km/h"},
		{UNIT_SPEED, "kmh", "km/h"},
		{UNIT_SPEED, "kmph", "km/h"},
		{UNIT_SPEED, "kph", "km/h"},
		{UNIT_SPEED, "mph", "mph"},
		{UNIT_LENGTH, "m", "m"},
		{UNIT_LENGTH, "meter", "m"},
		{UNIT_LENGTH, "meters", "m"},
		{UNIT_LENGTH, "cm", "cm"},
		{UNIT_LENGTH, "mm", "mm"},
		{UNIT_TURN, "rad/s", "rad/s"},
		{UNIT_TURN, "rad/sec", "rad/s"},
		{UNIT_TURN, "deg/s", "deg/s"},
		{UNIT_TURN, "deg/sec", "deg/s"},
		{UNIT_TURN, "degree/s", "deg/s"},
		{UNIT_TURN, "degrees/s", "deg/s"},
		{UNIT_TURN, "\xC2\xB0/s", "deg/s"},
		{UNIT_TURN, "\xB0/s", "deg/s"},
		{UNIT_SHARE, "%", "%"},
		{UNIT_SHARE, "percent", "%"},
		{UNIT_SHARE, "1", "1"},
	};

	for (size_t i = 0; i < sizeof(units) / sizeof(units[0]); i++) {
		if (units[i].kind == kind && !strcasecmp(units[i].spelt, name)) {
			return units[i].known;
		}
	}
	return NULL;
}
