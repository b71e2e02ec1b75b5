/* SPDX-License-Identifier: MIT
 * aebmc doctor: is this machine, and is its bus, fit for aebmcd? For each point what is, what should be, what mends it.
 */
#include "doctor.h"
#include "cli.h"
#include "cmd.h"
#include "json.h"
#include "setup.h"

struct args {
	struct setup setup;
	const char *root;
	int64_t seconds, bitrate;
	double sample_point;
	int json;
};

enum { KEY_JSON = 0x100, KEY_ROOT, KEY_SECONDS, KEY_BITRATE, KEY_SAMPLE_POINT };

static const struct argp_option options[] = {
	{"json", KEY_JSON, NULL, 0, "one JSON object on standard output", 1},
	{"seconds", KEY_SECONDS, "N", 0, "how long to look at each bus, 0..60 (default 2)", 1},
	{"bitrate", KEY_BITRATE, "BIT/S", 0, "of the buses (default 500000)", 1},
	{"sample-point", KEY_SAMPLE_POINT, "P", 0, "of the buses, 0.5..1 (default 0.875)", 1},
	{"root", KEY_ROOT, "DIR", OPTION_HIDDEN, "read everything below this folder", 1},
	{0},
};
static const struct argp_child children[] = {{&setup_argp, 0, NULL, 0}, {0}};

static error_t parse(int key, char *arg, struct argp_state *st)
{
	struct args *a = st->input;

	switch (key) {
	case ARGP_KEY_INIT:
		st->child_inputs[0] = &a->setup;
		return 0;
	case KEY_JSON:
		a->json = 1;
		return 0;
	case KEY_ROOT:
		a->root = arg;
		return 0;
	case KEY_SECONDS:
		return cli_count(st, "--seconds", arg, 0, 60, &a->seconds);
	case KEY_BITRATE:
		return cli_count(st, "--bitrate", arg, 5000, 1000000, &a->bitrate);
	case KEY_SAMPLE_POINT:
		return cli_number(st, "--sample-point", arg, 0.5, 1, &a->sample_point);
	case ARGP_KEY_ARG:
		return cli_bad(st, "'%s': takes no arguments, only options", arg);
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp argp = {options,
				 parse,
				 NULL,
				 "Says of each point of this machine and its CAN buses what is, "
				 "what should be and what mends it. Exit code 1 if something is "
				 "missing that aebmcd cannot do without.",
				 children,
				 NULL,
				 NULL};

/* ---- telling ------------------------------------------------------------------------------------ */

struct report {
	struct json *json; /* NULL: words */
	uint64_t count[DOCTOR_VERDICTS];
};

static const char *const verdict_name[] = {"good", "-", "advice", "MISSING"};
static const char *const verdict_json[] = {"good", "none", "advice", "missing"};

static void put_mend(FILE *out, const char *mend, const char *iface)
{
	for (; *mend; mend++) {
		if (*mend == '@' && iface) {
			fputs(iface, out);
		} else {
			fputc(*mend, out);
		}
	}
}

static void tell_words(const struct doctor_row *row, const char *iface, enum doctor_verdict v,
		       const char *is)
{
	char name[64];

	snprintf(name, sizeof(name), "%s%s%s", iface ? iface : "", iface ? " " : "", row->name);
	printf("%-8s %-20s %s\n", verdict_name[v], name, is);
	if (v >= DOCTOR_ADVICE) {
		printf("%-29s should be: %s\n%-29s mend it:   ", "", row->should, "");
		put_mend(stdout, row->mend, iface);
		putchar('\n');
	}
}

static void tell_json(struct json *j, const struct doctor_row *row, const char *iface,
		      enum doctor_verdict v, const char *is)
{
	char mend[512];
	FILE *out = fmemopen(mend, sizeof(mend), "w");

	if (out) {
		put_mend(out, row->mend, iface);
		fclose(out);
	}
	json_open(j, NULL, '{');
	json_str(j, "name", row->name);
	json_str(j, "interface", iface);
	json_str(j, "verdict", verdict_json[v]);
	json_str(j, "is", is);
	json_str(j, "should", row->should);
	json_str(j, "mend", out ? mend : NULL);
	json_close(j, '}');
}

static void tell(struct report *r, const struct doctor_row *row, const char *iface,
		 enum doctor_verdict v, const char *is)
{
	r->count[v]++;
	if (r->json) {
		tell_json(r->json, row, iface, v, is);
	} else {
		tell_words(row, iface, v, is);
	}
}

/* ---- examining ---------------------------------------------------------------------------------- */

static void examine_bus(const struct doctor *d, const struct args *a, const char *name,
			struct report *r)
{
	struct doctor_bus b = {.name = name,
			       .window_s = (double)a->seconds,
			       .bitrate = (uint32_t)a->bitrate,
			       .sample_point = a->sample_point};
	doctor_text is;

	doctor_bus_look(d, &b);
	for (int i = 0; i < DOCTOR_BUS_ROWS; i++) {
		const enum doctor_verdict v = doctor_bus_check(&b, i, is);

		tell(r, &doctor_bus_row[i], name, v, is);
	}
}

static void examine(struct doctor *d, const struct args *a, struct report *r)
{
	char name[BUS_IFACES_MAX][BUS_NAME_MAX];
	const int n = a->setup.path ? config_interfaces(d->cfg, name)
				    : doctor_bus_names(d, name, BUS_IFACES_MAX);
	doctor_text is;

	doctor_isolated_read(d);
	for (int i = 0; i < DOCTOR_MACHINE_ROWS; i++) {
		const enum doctor_verdict v = doctor_machine(d, i, is);

		tell(r, &doctor_machine_row[i], NULL, v, is);
	}
	for (int i = 0; i < n; i++) {
		examine_bus(d, a, name[i], r);
	}
}

static int conclude(const struct report *r)
{
	if (r->json) {
		json_close(r->json, ']');
		json_bool(r->json, "ready", !r->count[DOCTOR_MISSING]);
		json_close(r->json, '}');
	} else {
		printf("\n%llu good, %llu pieces of advice, %llu missing\n",
		       (unsigned long long)r->count[DOCTOR_GOOD],
		       (unsigned long long)r->count[DOCTOR_ADVICE],
		       (unsigned long long)r->count[DOCTOR_MISSING]);
	}
	return r->count[DOCTOR_MISSING] ? CLI_FAILED : CLI_GOOD;
}

int cmd_doctor(int argc, char **argv)
{
	struct args a = {.root = "", .seconds = 2, .bitrate = 500000, .sample_point = 0.875};
	struct config cfg;
	struct doctor d = {.cfg = &cfg};
	struct json j = json_start(stdout);
	struct report r = {0};
	int code = cli_parse(&argp, argc, argv, &a);

	code = code ? code : setup_load(argv[0], &a.setup, &cfg, NULL);
	if (code) {
		return code;
	}
	d.root = a.root;
	if (a.json) {
		r.json = &j;
		json_head(&j, "doctor");
		json_open(&j, "checks", '[');
	}
	examine(&d, &a, &r);
	return conclude(&r);
}
