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

struct role {
	const char *name;
	enum unit_kind unit;
	int required;
	int ego;       /* enum map_role, or -1: one signal for each radar target */
	size_t target; /* then the field of struct map_track */
	const char *doc;
};

#define EGO(name, unit, required, role, doc)       \
	{                                          \
		name, unit, required, role, 0, doc \
	}
#define TARGET(name, unit, required, doc)                                        \
	{                                                                        \
#name, unit, required, -1, offsetof(struct map_track, name), doc \
	}

/* distance comes first among the targets: it says how many there are. */
static const struct role roles[] = {
	EGO("ego_speed", UNIT_SPEED, 1, MAP_EGO_SPEED,
	    "speed of the car; up to 4 signals (wheels, say) are averaged"),
	EGO("yaw_rate", UNIT_TURN, 0, MAP_YAW_RATE, "positive when turning left"),
	EGO("driver_brake", UNIT_FLAG, 0, MAP_DRIVER_BRAKE, "brake pedal; not 0: pressed"),
	EGO("driver_accel", UNIT_SHARE, 0, MAP_DRIVER_ACCEL,
	    "accelerator pedal, share of its travel or a kick-down flag; see driver.override"),
	TARGET(distance, UNIT_LENGTH, 1, "to the target; vehicle.front_offset is added"),
	TARGET(rel_speed, UNIT_SPEED, 1, "target's speed less the car's: negative when closing"),
	TARGET(lateral, UNIT_LENGTH, 0, "sideways offset, left positive"),
	TARGET(valid, UNIT_FLAG, 0, "not 0: there is a target"),
	TARGET(fresh, UNIT_FLAG, 0, "not 0: the target has just appeared in this slot"),
	TARGET(existence, UNIT_SHARE, 0, "probability that the target exists"),
};

const struct map_key map_signal_keys[] = {
	{"from", "MESSAGE.SIGNAL, for targets one each: TRACK_{0..15}.DIST stands for TRACK_0.DIST "
		 "to TRACK_15.DIST"},
	{"unit", "the signal's unit, where the database gives none or a wrong one"},
	{"negate", "yes: the signal counts the other way round; of a flag: 0 means yes"},
	{"offset", "added after conversion, in the role's SI unit"},
	{"na",
	 "raw value that says not available; default: what the database calls \"not available\""},
};

const size_t map_signal_keys_len = MAP_COUNT(map_signal_keys);

/* What the keys of a [signal] section say of all its signals. */
struct tuning {
	const struct ini_entry *unit, *na;
	int negate;
	double offset;
};

static int read_tuning(const struct map_load *l, const char *section, struct tuning *t)
{
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
	return 0;
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
		      const struct tuning *t, const struct dbc_signal *sig, struct map_signal *s)
{
	const char *unit = t->unit ? t->unit->value : sig->unit;
	char known[128];

	*s = (struct map_signal){.sig = sig};
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
	return r->ego < 0 && r->target == offsetof(struct map_track, distance);
}

/* place_ego - where the @i-th signal of a role of the car itself goes; NULL after an error line */
static struct map_signal *place_ego(struct map_load *l, const struct ini_entry *from,
				    const struct role *r, int i, int msg)
{
	struct map_role_signals *role = &l->map->role[r->ego];

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

	if (is_distance(r)) {
		if (map->message[msg].track >= 0) {
			ini_fail(l->ini, from,
				 "message %s carries two targets; map one of a message", name);
			return NULL;
		}
		map->message[msg].track = (int16_t)i;
		map->track[i].message = (int16_t)msg;
		map->n_tracks = i + 1;
	}
	if (i >= map->n_tracks || map->track[i].message != msg) {
		ini_fail(l->ini, from,
			 "number %d is in message %s, unlike its distance; list messages alike",
			 i + 1, name);
		return NULL;
	}
	return (struct map_signal *)((char *)&map->track[i] + r->target);
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
	s = r->ego >= 0 ? place_ego(l, from, r, i, index) : place_target(l, from, r, i, index);
	return s ? set_signal(l, from, r, t, sig, s) : -EINVAL;
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
	if (!rc && r->ego < 0 && names.n != l->map->n_tracks) {
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
	return rc;
}

void mapping_print_roles(FILE *out)
{
	for (size_t i = 0; i < MAP_COUNT(roles); i++) {
		fprintf(out, "*[signal %s]*%s\n\t%s\n\n", roles[i].name,
			roles[i].required ? " (required)" : "", roles[i].doc);
	}
}
