/* SPDX-License-Identifier: MIT
 * [signal ROLE]: which signal plays the role, and how it becomes an SI value.
 */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "codec.h"
#include "mapping_load.h"
#include "text.h"
#include "unit.h"

#define OFFSET_MAX 1000.0 /* of the offset key, in the role's SI unit */

enum role_kind {
	ROLE_EGO,    /* up to MAP_SPEEDS_MAX signals */
	ROLE_LIST,   /* one signal, of the scan as a whole */
	ROLE_TARGET, /* one signal for each radar target, in the message of its distance */
	ROLE_QUALITY /* the same, or in a message of its own */
};

struct role {
	const char *name;
	enum unit_kind unit;
	int required;
	enum role_kind kind;
	size_t where; /* enum map_role, or the field of struct map_list or struct map_track */
	const char *doc;
};

#define EGO(name, unit, required, role, doc)              \
	{                                                 \
		name, unit, required, ROLE_EGO, role, doc \
	}
#define LIST(name, field, doc)                                                       \
	{                                                                            \
		name, UNIT_FLAG, 0, ROLE_LIST, offsetof(struct map_list, field), doc \
	}
#define TARGET(name, unit, required, doc)                                                 \
	{                                                                                 \
#name, unit, required, ROLE_TARGET, offsetof(struct map_track, name), doc \
	}
#define QUALITY(name, unit, doc)                                                    \
	{                                                                           \
#name, unit, 0, ROLE_QUALITY, offsetof(struct map_track, name), doc \
	}

/* The list comes before the targets: it says where they may be. distance comes first among them: it says how many there
 * are. */
static const struct role roles[] = {
	EGO("ego_speed", UNIT_SPEED, 1, MAP_EGO_SPEED,
	    "speed of the car; up to 4 signals (wheels, say) are averaged"),
	EGO("yaw_rate", UNIT_TURN, 0, MAP_YAW_RATE, "positive when turning left"),
	EGO("driver_brake", UNIT_FLAG, 0, MAP_DRIVER_BRAKE, "brake pedal; not 0: pressed"),
	EGO("driver_accel", UNIT_SHARE, 0, MAP_DRIVER_ACCEL,
	    "accelerator pedal, share of its travel or a kick-down flag; see driver.override"),
	LIST("object_count", count,
	     "in a message that begins each scan: how many objects follow; what is not sent is not "
	     "there"),
	LIST("scan_start", start,
	     "any signal of a message that begins each scan, where it does not say how many "
	     "follow"),
	LIST("object_id", id,
	     "the object's number, where one message carries all of them, one frame each; needs "
	     "object_count or scan_start"),
	LIST("quality_id", quality_id,
	     "the same number in a second message, which has more about the object"),
	TARGET(distance, UNIT_LENGTH, 1, "to the target; vehicle.front_offset is added"),
	TARGET(rel_speed, UNIT_SPEED, 1, "target's speed less the car's: negative when closing"),
	TARGET(lateral, UNIT_LENGTH, 0, "sideways offset, left positive"),
	TARGET(valid, UNIT_FLAG, 0, "not 0: there is a target"),
	TARGET(fresh, UNIT_FLAG, 0, "not 0: the target has just appeared in this slot"),
	QUALITY(existence, UNIT_SHARE, "probability that the target exists"),
	QUALITY(distance_sigma, UNIT_LENGTH,
		"noise of the distance (1 sigma); default: radar.range_sigma"),
	QUALITY(rate_sigma, UNIT_SPEED,
		"noise of the relative speed (1 sigma); default: radar.rate_sigma"),
};

const struct map_key map_signal_keys[] = {
	{"from", "MESSAGE.SIGNAL, for targets one each: TRACK_{0..15}.DIST stands for TRACK_0.DIST "
		 "to TRACK_15.DIST"},
	{"unit", "the signal's unit, where the database gives none or a wrong one"},
	{"negate", "yes: the signal counts the other way round; of a flag: 0 means yes"},
	{"offset", "added after conversion, in the role's SI unit"},
	{"na",
	 "raw value that says not available; default: what the database calls \"not available\""},
	{"table", "what the raw values 0, 1, ... stand for, up to 64 numbers; instead of the "
		  "database's scale"},
};

const size_t map_signal_keys_len = MAP_COUNT(map_signal_keys);

/* What the keys of a [signal] section say of all its signals. */
struct tuning {
	const struct ini_entry *unit, *na;
	const struct map_table *table;
	int negate;
	double offset;
};

static int read_tuning(struct map_load *l, const char *section, struct tuning *t)
{
	const struct ini_entry *table = ini_get(l->ini, section, "table");
	const struct ini_entry *negate = ini_get(l->ini, section, "negate");
	const struct ini_entry *offset = ini_get(l->ini, section, "offset");

	*t = (struct tuning){.unit = ini_get(l->ini, section, "unit"),
			     .na = ini_get(l->ini, section, "na")};
	if (negate && text_truth(negate->value, &t->negate)) {
		return ini_fail(l->ini, negate, "'%.40s' is neither yes nor no", negate->value);
	}
	if (offset && (text_number(offset->value, &t->offset) || fabs(t->offset) > OFFSET_MAX)) {
		return ini_fail(l->ini, offset, "'%.40s' is no number from -%g to %g",
				offset->value, OFFSET_MAX, OFFSET_MAX);
	}
	return table ? mapping_load_table(l, table, &t->table) : 0;
}

/* set_na - the raw value that says not available, given or found in the database */
static int set_na(const struct map_load *l, const struct tuning *t, struct map_signal *s)
{
	int64_t raw = -1;

	if (!t->na) {
		s->has_na = !dbc_value_raw(s->sig, "not available", &s->na_raw);
		return 0;
	}
	if (text_integer(t->na->value, &raw) || raw < 0 || (uint64_t)raw > codec_mask(s->sig)) {
		return ini_fail(l->ini, t->na,
				"'%.40s' is no raw value of %s; allowed: 0 to 0x%" PRIX64,
				t->na->value, s->sig->name, codec_mask(s->sig));
	}
	s->has_na = 1;
	s->na_raw = (uint64_t)raw;
	return 0;
}

/* set_signal - how @sig becomes the role's SI value */
static int set_signal(const struct map_load *l, const struct ini_entry *from, const struct role *r,
		      const struct tuning *t, int msg, const struct dbc_signal *sig,
		      struct map_signal *s)
{
	const char *unit = t->unit ? t->unit->value : sig->unit;
	char known[128];

	*s = (struct map_signal){.sig = sig, .table = t->table, .message = (int16_t)msg};
	if (unit_gain(r->unit, unit, &s->gain)) {
		return ini_fail(l->ini, t->unit ? t->unit : from,
				"%s: unknown unit '%.40s'; set unit to one of: %s", sig->name, unit,
				unit_list(r->unit, known, sizeof(known)));
	}
	if (t->negate) {
		s->gain = -s->gain;
		s->offset = r->unit == UNIT_FLAG ? 1.0 : 0.0; /* 1 - x turns a flag round */
	}
	s->offset += t->offset;
	return set_na(l, t, s);
}

/* is_distance - the first role of the targets, which places them */
static int is_distance(const struct role *r)
{
	return r->kind == ROLE_TARGET && r->where == offsetof(struct map_track, distance);
}

/* place_ego - where the @i-th signal of a role of the car itself goes; NULL after an error line */
static struct map_signal *place_ego(struct map_load *l, const struct ini_entry *from,
				    const struct role *r, int i, int msg)
{
	struct map_role_signals *role = &l->map->role[r->where];

	if (i == MAP_SPEEDS_MAX) {
		ini_fail(l->ini, from, "more than %d signals; name fewer", MAP_SPEEDS_MAX);
		return NULL;
	}
	l->map->message[msg].ego = 1;
	role->message[i] = (int16_t)msg;
	role->n = i + 1;
	return &role->signal[i];
}

/* place_target - where the signal of the @i-th radar target goes; NULL after an error line */
static struct map_signal *place_target(struct map_load *l, const struct ini_entry *from,
				       const struct role *r, int i, int msg)
{
	struct mapping *map = l->map;
	const char *name = map->message[msg].msg->name;
	const int is_quality = r->kind == ROLE_QUALITY && map->list.quality == msg;

	if (is_distance(r)) {
		if (map->message[msg].track >= 0) {
			ini_fail(l->ini, from,
				 "message %s carries two targets; map one of a message", name);
			return NULL;
		}
		map->message[msg].track = (int16_t)i;
		map->message[msg].part = MAP_TARGET;
		map->track[i].message = (int16_t)msg;
		map->n_tracks = i + 1;
	}
	if (i >= map->n_tracks || (map->track[i].message != msg && !is_quality)) {
		ini_fail(l->ini, from,
			 "number %d is in message %s, unlike its distance; list messages alike",
			 i + 1, name);
		return NULL;
	}
	return (struct map_signal *)((char *)&map->track[i] + r->where);
}

/* place - where the @i-th signal of a role goes; NULL after an error line */
static struct map_signal *place(struct map_load *l, const struct ini_entry *from,
				const struct role *r, int i, int msg)
{
	if (r->kind == ROLE_EGO) {
		return place_ego(l, from, r, i, msg);
	}
	if (r->kind == ROLE_LIST && i > 0) {
		ini_fail(l->ini, from, "more than one signal; name one");
		return NULL;
	}
	return r->kind == ROLE_LIST ? (struct map_signal *)((char *)&l->map->list + r->where)
				    : place_target(l, from, r, i, msg);
}

/* load_one - one MESSAGE.SIGNAL of a role */
static int load_one(struct map_load *l, const struct ini_entry *from, const struct role *r,
		    const struct tuning *t, int i, char *spec)
{
	const struct dbc_message *msg;
	const struct dbc_signal *sig;
	struct map_signal *s;
	char *dot = strchr(spec, '.');
	int index;

	if (!dot) {
		return ini_fail(l->ini, from, "'%.128s' names no signal; write MESSAGE.SIGNAL",
				spec);
	}
	*dot = '\0';
	index = mapping_use(l, from, spec);
	if (index < 0) {
		return index;
	}
	msg = l->map->message[index].msg;
	sig = dbc_find_signal(msg, dot + 1);
	if (!sig) {
		return mapping_no_signal(l, from, msg, dot + 1);
	}
	s = place(l, from, r, i, index);
	if (!s) {
		return -EINVAL;
	}
	return set_signal(l, from, r, t, index, sig, s) ||
			       (r->kind == ROLE_LIST && mapping_place_list(l, from, s))
		       ? -EINVAL
		       : 0;
}

static int load_role(struct map_load *l, const struct role *r)
{
	struct map_names names;
	struct tuning tuning;
	char section[INI_NAME_MAX];
	const struct ini_entry *from, *header;
	int rc;

	snprintf(section, sizeof(section), "signal %s", r->name);
	from = ini_get(l->ini, section, "from");
	header = ini_get(l->ini, section, "");
	if (!from) {
		return header || r->required
			       ? ini_fail(l->ini, header,
					  "%s: not mapped; write [%s] from = MESSAGE.SIGNAL",
					  r->name, section)
			       : 0;
	}
	rc = read_tuning(l, section, &tuning);
	tuning.offset += is_distance(r) ? l->cfg->vehicle_front_offset : 0.0;
	rc = rc ? rc : mapping_expand(l, from, from->value, &names);
	for (int i = 0; !rc && i < names.n; i++) {
		rc = load_one(l, from, r, &tuning, i, names.name[i]);
	}
	if (!rc && r->kind >= ROLE_TARGET && names.n != l->map->n_tracks) {
		rc = ini_fail(l->ini, from, "%d signals for %d targets; name one for each", names.n,
			      l->map->n_tracks);
	}
	return rc;
}

/* check_section - is there such a role, and does it have such keys? */
static int check_section(const struct map_load *l, const struct ini_entry *header, const char *role)
{
	for (size_t i = 0; i < MAP_COUNT(roles); i++) {
		if (!strcmp(roles[i].name, role)) {
			return mapping_check_keys(l, header->section, map_signal_keys,
						  map_signal_keys_len);
		}
	}
	return ini_fail(l->ini, header, "no such role '%s' (nearest: %s)", role,
			text_nearest(role, &roles[0].name, MAP_COUNT(roles), sizeof(roles[0])));
}

int mapping_load_signals(struct map_load *l)
{
	int rc = 0;

	for (int i = 0; !rc && i < l->ini->n; i++) {
		const struct ini_entry *e = &l->ini->entry[i];
		const char *role = mapping_argument(e->section, "signal");

		if (role && !e->key[0]) {
			rc = check_section(l, e, role);
		}
	}
	for (size_t i = 0; !rc && i < MAP_COUNT(roles); i++) {
		rc = load_role(l, &roles[i]);
	}
	return rc ? rc : mapping_check_list(l);
}

void mapping_print_roles(FILE *out)
{
	for (size_t i = 0; i < MAP_COUNT(roles); i++) {
		fprintf(out, "*[signal %s]*%s\n\t%s\n\n", roles[i].name,
			roles[i].required ? " (required)" : "", roles[i].doc);
	}
}
