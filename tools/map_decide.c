/* SPDX-License-Identifier: MIT
 * Which candidate plays a role: the one that was told, the one that is clear, or the one chosen on a terminal. Never a
 * guess without a word.
 */
#include <string.h>
#include <unistd.h>
#include "cli.h"
#include "map.h"
#include "text.h"

#define SHOWN      5 /* candidates */
#define ANSWER_MAX 512

/* ---- told -------------------------------------------------------------------------------------- */

/* The first decision for a role, behind its "=", or NULL. */
static const char *told(const struct map_args *a, const char *role)
{
	const size_t n = strlen(role);

	for (int i = 0; i < a->n_roles; i++) {
		if (!strncmp(a->role[i], role, n) && a->role[i][n] == '=') {
			return a->role[i] + n + 1;
		}
	}
	return NULL;
}

int map_check_roles(const struct map *p)
{
	const struct map_args *a = p->args;

	for (int i = 0; i < a->n_roles; i++) {
		const size_t n = strcspn(a->role[i], "=");
		char name[32];
		int r = 0;

		snprintf(name, sizeof(name), "%.*s", (int)(n < 31 ? n : 31), a->role[i]);
		while (r < MAPPER_ROLES && strcmp(mapper_role_table[r].name, name)) {
			r++;
		}
		if (r == MAPPER_ROLES || !a->role[i][n]) {
			return cli_error(
				CLI_USAGE, p->name,
				"--role: '%s' is no NAME=MESSAGE.SIGNAL; nearest name is '%s'",
				a->role[i],
				text_nearest(name, &mapper_role_table[0].name, MAPPER_ROLES,
					     sizeof(mapper_role_table[0])));
		}
	}
	return 0;
}

/* The family that @name is, or is a member of; -1. */
static int find_family(const struct mapper *m, const char *name)
{
	for (int i = 0; i < m->n_families; i++) {
		for (int k = 0; k < m->family[i].n; k++) {
			if (!strcmp(m->family[i].name, name) ||
			    !strcmp(m->family[i].member[k]->name, name)) {
				return i;
			}
		}
	}
	return -1;
}

static int set_unit(const struct map *p, struct mapper_candidate *c, enum mapper_role role,
		    const char *unit)
{
	const enum unit_kind kind = mapper_role_table[role].unit;
	const char *known = unit ? mapper_unit(kind, unit) : NULL;
	char list[128];
	double gain;

	if (unit && !known) {
		return cli_error(CLI_FAILED, p->name, "%s: unit '%.20s' is not known; one of: %s",
				 mapper_role_table[role].name, unit,
				 unit_list(kind, list, sizeof(list)));
	}
	c->unit = known ? known : c->unit;
	if (unit_gain(kind, c->unit ? c->unit : c->sig[0]->unit, &gain)) {
		return cli_error(CLI_FAILED, p->name,
				 "%s: the database gives %s no unit that is known; write "
				 "--role %s=MESSAGE.SIGNAL:UNIT with one of: %s",
				 mapper_role_table[role].name, c->sig[0]->name,
				 mapper_role_table[role].name, unit_list(kind, list, sizeof(list)));
	}
	return 0;
}

/* "MESSAGE.SIGNAL", which is taken apart, as a candidate. 0, or an exit code after one line. */
static int find(const struct map *p, const char *role, char *spec, struct mapper_candidate *c)
{
	char *dot = strchr(spec, '.');

	if (!dot) {
		return cli_error(CLI_FAILED, p->name,
				 "%s: '%s' names no signal; write MESSAGE.SIGNAL", role, spec);
	}
	*dot = '\0';
	c->family = find_family(p->m, spec);
	if (c->family < 0) {
		return cli_error(CLI_FAILED, p->name, "%s: no message '%s'; nearest is '%s'", role,
				 spec, dbc_nearest(p->m->dbc, NULL, spec));
	}
	const struct dbc_message *msg = p->m->family[c->family].member[0];

	c->n = 1;
	c->sig[0] = dbc_find_signal(msg, dot + 1);
	if (!c->sig[0]) {
		return cli_error(CLI_FAILED, p->name,
				 "%s: message %s has no signal '%s'; nearest is '%s'", role,
				 msg->name, dot + 1, dbc_nearest(p->m->dbc, msg, dot + 1));
	}
	snprintf(c->why, sizeof(c->why), "as told");
	return 0;
}

/* "MESSAGE.SIGNAL[:UNIT]" or "none" as the choice. 0, or an exit code after one line. */
static int decide(struct map *p, enum mapper_role role, const char *text)
{
	struct mapper_choice *c = &p->choice[role];
	struct mapper_candidate new = {0};
	char copy[ANSWER_MAX];

	snprintf(copy, sizeof(copy), "%s", text);
	c->taken = -1;
	if (!strcmp(copy, "none")) {
		return mapper_role_table[role].required
			       ? cli_error(CLI_FAILED, p->name,
					   "%s: cannot be none: aebmcd takes no configuration "
					   "without it",
					   mapper_role_table[role].name)
			       : 0;
	}
	char *unit = strchr(copy, ':');

	if (unit) {
		*unit++ = '\0';
	}
	const int code = find(p, mapper_role_table[role].name, copy, &new);

	if (code) {
		return code;
	}
	for (int i = 0; i < c->n; i++) {
		if (c->at[i].family == new.family && c->at[i].sig[0] == new.sig[0]) {
			new = c->at[i];
		}
	}
	c->at[0] = new;
	c->n = c->n ? c->n : 1;
	c->taken = 0;
	return set_unit(p, &c->at[0], role, unit);
}

/* ---- words ------------------------------------------------------------------------------------- */

static void show_candidate(const struct map *p, const char *mark, const struct mapper_candidate *c)
{
	char spec[MAPPER_SPEC_MAX];

	fprintf(p->words, "  %-6s %-36s %5.1f  %s\n", mark, mapper_spec(p->m, c, spec), c->score,
		c->why);
}

static void show(const struct map *p, enum mapper_role role)
{
	const struct mapper_choice *c = &p->choice[role];
	char mark[16], list[128];

	fprintf(p->words, "%s: %s\n", mapper_role_table[role].name, mapper_role_table[role].doc);
	for (int i = 0; i < c->n && i < SHOWN; i++) {
		snprintf(mark, sizeof(mark), i == c->taken ? "taken" : "%d", i + 1);
		show_candidate(p, mark, &c->at[i]);
	}
	if (c->taken < 0) {
		fprintf(p->words, "  %s\n", c->n ? "none taken" : "no candidate");
	}
	if (c->taken < 0 && c->strange) {
		fprintf(p->words,
			"  %s.%s is named so, but its unit '%s' is not known; --role %s=%s.%s:UNIT "
			"with one of: %s\n",
			p->m->family[c->strange_family].name, c->strange->name, c->strange->unit,
			mapper_role_table[role].name, p->m->family[c->strange_family].name,
			c->strange->name,
			unit_list(mapper_role_table[role].unit, list, sizeof(list)));
	}
}

/* ---- roles ------------------------------------------------------------------------------------- */

static int is_weak(const struct mapper_choice *c)
{
	return !c->n || c->at[0].score < MAPPER_SCORE_MIN;
}

static int is_terminal(void)
{
	return isatty(STDIN_FILENO) && isatty(STDOUT_FILENO);
}

/* From a terminal: a number, a signal, or nothing for none. */
static int ask_for(struct map *p, enum mapper_role role)
{
	char answer[ANSWER_MAX];
	int64_t number;

	for (;;) {
		printf("  which? a number, MESSAGE.SIGNAL[:UNIT], or none: ");
		fflush(stdout);
		if (!fgets(answer, sizeof(answer), stdin)) {
			return cli_error(CLI_FAILED, p->name, "no answer");
		}
		answer[strcspn(answer, "\n")] = '\0';
		if (!text_integer(answer, &number) && number >= 1 && number <= p->choice[role].n) {
			p->choice[role].taken = (int)number - 1;
			if (!set_unit(p, &p->choice[role].at[number - 1], role, NULL)) {
				return 0;
			}
		} else if (answer[0] && !decide(p, role, answer)) {
			return 0;
		}
		p->choice[role].taken = -1;
	}
}

/* To be decided: a role that is needed, or one with a good candidate that is not clearly the best. */
static int is_open(const struct mapper_choice *c, enum mapper_role role, int needed)
{
	return c->taken < 0 && (needed || mapper_role_table[role].required || !is_weak(c));
}

static int settle(struct map *p, enum mapper_role role, int needed)
{
	struct mapper_choice *c = &p->choice[role];
	const char *text = told(p->args, mapper_role_table[role].name);
	int code = 0;

	if (text) {
		code = decide(p, role, text);
	} else if (mapper_is_clear(c)) {
		c->taken = 0;
		code = set_unit(p, &c->at[0], role, NULL);
	}
	if (code) {
		return code;
	}
	show(p, role);
	if (text || !is_open(c, role, needed)) {
		return 0;
	}
	if (is_terminal()) {
		return ask_for(p, role);
	}
	fprintf(p->words, "  not clear: --role %s=MESSAGE.SIGNAL%s\n", mapper_role_table[role].name,
		mapper_role_table[role].required ? "" : " or none");
	p->open++;
	return 0;
}

static const struct mapper_candidate *taken(const struct map *p, enum mapper_role role)
{
	const struct mapper_choice *c = &p->choice[role];

	return c->taken >= 0 ? &c->at[c->taken] : NULL;
}

/* 1 if the role means nothing with what was taken so far. */
static int is_pointless(const struct map *p, enum mapper_role role)
{
	const struct mapper_candidate *distance = taken(p, MAPPER_distance);

	if (mapper_role_table[role].whose == MAPPER_TARGET && role != MAPPER_distance) {
		return !distance ||
		       (role == MAPPER_object_id && p->m->family[distance->family].n > 1);
	}
	return role == MAPPER_object_count && !taken(p, MAPPER_object_id);
}

int map_decide(struct map *p)
{
	int code = 0;

	for (int r = 0; r < MAPPER_ROLES && !code; r++) {
		const enum mapper_role role = (enum mapper_role)r;
		const struct mapper_candidate *distance = taken(p, MAPPER_distance);
		const int beside = mapper_role_table[r].whose != MAPPER_CAR && r != MAPPER_distance;

		p->choice[r].taken = -1;
		if (!is_pointless(p, role)) {
			mapper_rank(p->m, role, beside ? distance->family : -1, distance,
				    &p->choice[r]);
			code = settle(p, role, role == MAPPER_object_count);
		}
	}
	return code;
}
