/* SPDX-License-Identifier: MIT
 * pipeline: the event loop on a bus in memory, with an estimator that hands out the scene a test wants and a backend that
 * answers what a test wants. Times are virtual throughout.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include "clock.h"
#include "codec.h"
#include "contract.h"
#include "estimator.h"
#include "mc_ops.h"
#include "pipeline.h"
#include "recorder.h"

#define MS       CLOCK_NS_PER_MS
#define T0       (1000 * CLOCK_NS_PER_S) /* first frame, an ego one */
#define SCAN_0   (T0 + 45 * MS)          /* first scan; on no request period, like all */
#define SCAN     (50 * MS)
#define PERIOD   (20 * MS)
#define OUT_MAX  20000
#define ID_SCAN  0x100
#define ID_EGO   0x101
#define ID_OPENS 0x102 /* opens a scan that silence ends */

/* ---- the world: what the fakes do and saw ---------------------------------------------------------- */

static struct world {
	/* bus */
	int64_t now_ns, next_scan_ns, end_ns;
	int64_t oversleep_ns; /* the next wait takes so much longer */
	int radar, recv_error, send_error;
	uint32_t scan_id, events;
	int drained, watched_fd;
	struct bus_frame *out;
	int n_out;
	/* estimator */
	struct scene scene;
	int64_t scan_ns, pending_ns, stale_ns;
	uint64_t scans;
	int distrusted;
	/* backend */
	double risk[FUTURES];
	uint32_t n, res_flags;
	uint64_t cut_seen; /* atomic */
	int run_error, wrong_hash;
	int runs;    /* atomic */
	int block;   /* atomic: run() waits for a permit, or until cut */
	int permits; /* atomic */
	int deaf;    /* run() ignores the cut */
	/* callbacks */
	int cycles, changes;
	struct cycle cycle;
	struct publish_in change;
	int64_t clock_ns;

	struct config cfg;
	struct bus bus;
	struct mc *mc;
	struct pipeline *p;
	/* echo */
	int64_t echo_ns; /* the expected frame was seen then; 0: not yet */
	struct bus_frame expected;
	/* tracer */
	struct told {
		int edges[EDGES], evaluations, clocks, published, faults, states;
		uint64_t misses[MISSES];
		char stage[16];           /* of the last stage miss */
		uint64_t cycle;           /* of the last miss */
		int64_t late_ns;          /* of the last miss */
		struct hist hist[STAGES]; /* of the stages, from the edges as they were told */
		uint64_t id;              /* the cycle that the edges below are of */
		int64_t t_ns[EDGES];
		struct trace_evaluation evaluation;
	} told;
} w;

/* ---- a bus in memory, with the log's rules ----------------------------------------------------------- */

static int fake_recv(struct bus *b, struct bus_frame *f, int max, int64_t until_ns, int64_t *now_ns)
{
	int first = !w.now_ns;
	int64_t next_ns = first ? T0 : w.radar ? w.next_scan_ns : CLOCK_NEVER;

	(void)b;
	assert_true(max > 0);
	if (w.recv_error) {
		return w.recv_error;
	}
	if (next_ns > w.end_ns && until_ns > w.end_ns) {
		return -ENODATA;
	}
	if (!first && next_ns > until_ns) {
		w.now_ns = until_ns + w.oversleep_ns;
		w.oversleep_ns = 0;
		*now_ns = w.now_ns;
		return 0;
	}
	w.now_ns = (next_ns > w.now_ns ? next_ns : w.now_ns) + w.oversleep_ns;
	*now_ns = w.now_ns;
	w.oversleep_ns = 0;
	f[0] = (struct bus_frame){.t_ns = next_ns, .id = first ? ID_EGO : w.scan_id, .len = 8};
	w.next_scan_ns += first ? 0 : SCAN;
	return 1;
}

static int fake_send(struct bus *b, const struct bus_frame *f)
{
	(void)b;
	if (w.send_error) {
		return w.send_error;
	}
	assert_true(w.n_out < OUT_MAX);
	w.out[w.n_out++] = *f;
	return 0;
}

static const struct bus_ops log_ops = {.name = "memory", .recv = fake_recv, .send = fake_send};

static uint32_t fake_events(struct bus *b)
{
	(void)b;
	return w.events;
}

static void fake_drain(struct bus *b)
{
	(void)b;
	w.drained++;
}

static int fake_watch(struct bus *b, int fd)
{
	(void)b;
	w.watched_fd = fd;
	return 0;
}

static void fake_expect(struct bus *b, const struct bus_frame *f)
{
	(void)b;
	w.expected = *f;
	w.echo_ns = 0;
}

static int64_t fake_expected_ns(const struct bus *b)
{
	(void)b;
	return w.echo_ns;
}

static const struct bus_ops echo_ops = {.name = "echo",
					.recv = fake_recv,
					.send = fake_send,
					.expect = fake_expect,
					.expected_ns = fake_expected_ns};

static const struct bus_ops live_ops = {.name = "live",
					.recv = fake_recv,
					.send = fake_send,
					.events = fake_events,
					.watch = fake_watch,
					.drain = fake_drain};

/* ---- the estimator: linked here instead of the real one ------------------------------------------------ */

struct estimator {
	uint64_t rejected[SCENE_REJECTS];
};

int estimator_open(const struct config *cfg, const struct mapping *map, struct estimator **ret)
{
	(void)cfg;
	(void)map;
	*ret = calloc(1, sizeof(**ret));
	return *ret ? 0 : -ENOMEM;
}

static int end_scan(int64_t t_ns)
{
	w.scans++;
	w.scan_ns = t_ns;
	w.pending_ns = CLOCK_NEVER;
	return 1;
}

int estimator_frame(struct estimator *e, const struct bus_frame *f)
{
	e->rejected[SCENE_REJECT_CRC]++;
	if (f->id == ID_OPENS) {
		w.pending_ns = f->t_ns + 12 * MS;
	}
	return f->id == ID_SCAN ? end_scan(f->t_ns) : 0;
}

int64_t estimator_deadline(const struct estimator *e)
{
	(void)e;
	return w.pending_ns;
}

int estimator_tick(struct estimator *e, int64_t now_ns)
{
	(void)e;
	return now_ns >= w.pending_ns ? end_scan(now_ns) : 0;
}

int64_t estimator_stale_ns(const struct estimator *e, int64_t now_ns)
{
	(void)e;
	return w.stale_ns > now_ns ? w.stale_ns : CLOCK_NEVER;
}

void estimator_scene(struct estimator *e, int64_t now_ns, struct scene *s)
{
	(void)e;
	*s = w.scene;
	s->fault |= now_ns >= w.stale_ns ? FAULT_BIT(EGO_STALE) : 0;
	s->t_ns = now_ns;
	s->scan = w.scans;
	s->scan_ns = w.scan_ns;
	s->fault |= w.scans ? 0 : FAULT_BIT(STARTING);
}

const uint64_t *estimator_rejected(const struct estimator *e)
{
	return e->rejected;
}

void estimator_distrust(struct estimator *e)
{
	(void)e;
	w.distrusted++;
}

void estimator_close(struct estimator *e)
{
	free(e);
}

/* ---- the recorder: the same ------------------------------------------------------------------------------- */

static struct recorder {
	int frames, evaluations;
	int triggers[RECORDER_REASONS];
	int64_t t_ns; /* of the last trigger */
} kept;

void recorder_frame(struct recorder *r, const struct bus_frame *f)
{
	(void)f;
	r->frames++;
}

void recorder_evaluation(struct recorder *r, int64_t t_ns, const struct mc_request *req,
			 const struct mc_result *res)
{
	assert_int_equal(t_ns, w.now_ns);
	assert_true(res->id == req->id);
	r->evaluations++;
}

void recorder_trigger(struct recorder *r, enum recorder_reason why, int64_t t_ns)
{
	r->triggers[why]++;
	r->t_ns = t_ns;
}

/* ---- a backend --------------------------------------------------------------------------------------- */

static int fake_open(const struct mc_params *p, struct mc_backend **ret)
{
	(void)p;
	*ret = NULL;
	return 0;
}

static int wait_while_blocked(uint64_t id, const uint64_t *cut)
{
	while (__atomic_load_n(&w.block, __ATOMIC_ACQUIRE)) {
		uint64_t c = __atomic_load_n(cut, __ATOMIC_ACQUIRE);

		__atomic_store_n(&w.cut_seen, c, __ATOMIC_RELEASE);
		if (c == UINT64_MAX || (c >= id && !w.deaf)) {
			return 1;
		}
		if (__atomic_load_n(&w.permits, __ATOMIC_ACQUIRE) > 0) {
			__atomic_sub_fetch(&w.permits, 1, __ATOMIC_ACQ_REL);
			return 0;
		}
		poll(NULL, 0, 1);
	}
	return 0;
}

static int fake_run(struct mc_backend *b, const struct mc_request *req, const uint64_t *cut,
		    struct mc_result *res)
{
	int was_cut = wait_while_blocked(req->id, cut);

	(void)b;
	__atomic_add_fetch(&w.runs, 1, __ATOMIC_RELAXED);
	*res = (struct mc_result){.id = req->id,
				  .req_hash = mc_request_hash(req) + (uint64_t)w.wrong_hash,
				  .n = was_cut ? 1 : w.n,
				  .flags = was_cut ? MC_RES_CUT : w.res_flags,
				  .n_futures = FUTURES};
	for (int i = 0; i < FUTURES; i++) {
		res->risk[i] = (struct mc_risk){.p = w.risk[i], .lo = w.risk[i], .hi = w.risk[i]};
	}
	return w.run_error;
}

static void fake_close(struct mc_backend *b)
{
	(void)b;
}

static const struct mc_ops fake_ops = {
	.name = "fake", .open = fake_open, .run = fake_run, .close = fake_close};

/* ---- help ---------------------------------------------------------------------------------------------- */

static void on_cycle(void *arg, const struct cycle *c, enum state state)
{
	(void)state;
	assert_ptr_equal(arg, &w);
	w.cycles++;
	w.cycle = *c;
}

static void on_change(void *arg, int64_t t_ns, const struct publish_in *now)
{
	assert_ptr_equal(arg, &w);
	assert_int_equal(t_ns, w.now_ns);
	w.changes++;
	w.change = *now;
}

static int64_t fake_clock(void)
{
	return w.clock_ns += MS;
}

static void safe_scene(void)
{
	w.scene = (struct scene){.ego_valid = 1,
				 .lead_valid = 1,
				 .lead_scans = 100,
				 .driver_brake = -1,
				 .driver_accel = -1,
				 .oldest_input_ns = 30 * MS,
				 .x = {60, 20, 0, 20, 0}};
	for (int i = 0; i < SCENE_DIM; i++) {
		w.scene.cov[i][i] = 0.01;
	}
	memset(w.risk, 0, sizeof(w.risk));
}

static void dangerous_scene(void)
{
	safe_scene();
	w.scene.x[SCENE_HEADWAY] = 8; /* also by the deterministic rule: 0.8 s, 7.1 m/s2 */
	w.scene.x[SCENE_LEAD_SPEED] = 10;
	for (int i = 0; i < FUTURES; i++) {
		w.risk[i] = 0.9;
	}
}

static struct pipeline_open options(int64_t (*clock)(void))
{
	return (struct pipeline_open){.cfg = &w.cfg,
				      .bus = &w.bus,
				      .mc = w.mc,
				      .backend = PUBLISH_BACKEND_CPU,
				      .clock = clock,
				      .on_cycle = on_cycle,
				      .on_change = on_change,
				      .arg = &w};
}

static void begin(const struct bus_ops *ops, int worker, int64_t (*clock)(void))
{
	const struct mc_params params = {.n_resident = 256, .threads = 1};
	struct bus_frame *out = w.out ? w.out : malloc(OUT_MAX * sizeof(*out));

	w = (struct world){.next_scan_ns = SCAN_0,
			   .end_ns = CLOCK_NEVER - 1,
			   .radar = 1,
			   .scan_id = ID_SCAN,
			   .pending_ns = CLOCK_NEVER,
			   .stale_ns = CLOCK_NEVER,
			   .watched_fd = -1,
			   .n = 16384,
			   .out = out};
	w.bus.ops = ops;
	safe_scene();
	config_defaults(&w.cfg);
	assert_non_null(out);
	assert_int_equal(mc_open(&fake_ops, &params, worker, &w.mc), 0);
	const struct pipeline_open o = options(clock);

	assert_int_equal(pipeline_open(&o, &w.p), 0);
}

/* The same world with other options. */
static void reopen(const struct pipeline_open *o)
{
	pipeline_close(w.p);
	assert_int_equal(pipeline_open(o, &w.p), 0);
}

static void end(void)
{
	pipeline_close(w.p);
	__atomic_store_n(&w.block, 0, __ATOMIC_RELEASE);
	mc_close(w.mc);
}

/* All events before @t_ns. */
static void run_to(int64_t t_ns)
{
	while (w.now_ns < t_ns) {
		assert_int_equal(pipeline_step(w.p), 0);
	}
}

/* All events of the first @n scans. */
static void run_scans(int n)
{
	run_to(SCAN_0 + (n - 1) * SCAN);
}

static void await_result(void)
{
	struct pollfd fd = {.fd = mc_eventfd(w.mc), .events = POLLIN};

	assert_int_equal(poll(&fd, 1, 10000), 1);
}

/* Lets one batch end and waits, in real time, for its result. */
static void let_one_pass(void)
{
	__atomic_add_fetch(&w.permits, 1, __ATOMIC_ACQ_REL);
	await_result();
}

static uint64_t raw(const struct bus_frame *f, enum contract_signal which)
{
	return codec_raw(&contract_signal[which], f->data);
}

/* The last frame of a kind. */
static const struct bus_frame *last(enum publish_msg which)
{
	for (int i = w.n_out - 1; i >= 0; i--) {
		if (w.out[i].id == 0x2A0u + which) {
			return &w.out[i];
		}
	}
	fail_msg("no frame of kind %d", which);
	return NULL;
}

static int count(enum publish_msg which)
{
	int n = 0;

	for (int i = 0; i < w.n_out; i++) {
		n += w.out[i].id == 0x2A0u + which;
	}
	return n;
}

static void request_is(const char *state, const char *stage, const char *request)
{
	const struct bus_frame *f = last(PUBLISH_REQUEST);
	const struct dbc_signal *sig = contract_signal;

	assert_string_equal(dbc_value_text(&sig[AEB_REQUEST_STATE], raw(f, AEB_REQUEST_STATE)),
			    state);
	assert_string_equal(dbc_value_text(&sig[AEB_REQUEST_STAGE], raw(f, AEB_REQUEST_STAGE)),
			    stage);
	assert_string_equal(dbc_value_text(&sig[AEB_REQUEST_REQUEST], raw(f, AEB_REQUEST_REQUEST)),
			    request);
}

static int has_risk(void)
{
	return raw(last(PUBLISH_REQUEST), AEB_REQUEST_P_COLLISION) !=
	       AEB_REQUEST_P_COLLISION_NOT_AVAILABLE;
}

static uint32_t reasons(void)
{
	return (uint32_t)raw(last(PUBLISH_STATUS), AEB_STATUS_REASONS);
}

/* ---- start and period ---------------------------------------------------------------------------------- */

static void test_init_frames_come_first(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(w.out[0].t_ns, T0);
	assert_int_equal(w.out[0].id, 0x2A0);
	request_is("INIT", "none", "none");
	assert_int_equal(raw(&w.out[0], AEB_REQUEST_TTL), 0);
	assert_int_equal(raw(&w.out[0], AEB_REQUEST_EVAL_ID), 0);
	assert_false(has_risk());
	assert_int_equal(reasons(), FAULT_BIT(STARTING));
	w.radar = 0;
	run_to(T0 + 5 * CLOCK_NS_PER_S);
	request_is("INIT", "none", "none");
	assert_false(has_risk());
	assert_int_equal(w.changes, 0);
	assert_int_equal(count(PUBLISH_RISK), 0);
	w.next_scan_ns = w.now_ns + 5 * MS;
	w.radar = 1;
	run_to(w.next_scan_ns);
	request_is("ARMED", "none", "none"); /* told at once, not at the next period */
	assert_int_equal(last(PUBLISH_REQUEST)->t_ns, w.scan_ns);
	assert_int_equal(w.changes, 1);
	end();
}

/* In every state, whatever else happens. */
static void test_request_period_is_exact(void **arg)
{
	int64_t next_ns = T0;
	int extra = 0;

	(void)arg;
	begin(&log_ops, 0, NULL);
	run_to(T0 + 2 * CLOCK_NS_PER_S);
	dangerous_scene();
	run_to(T0 + 4 * CLOCK_NS_PER_S);
	w.radar = 0;
	run_to(T0 + 6 * CLOCK_NS_PER_S);
	for (int i = 0; i < w.n_out; i++) {
		if (w.out[i].id != 0x2A0) {
			continue;
		}
		if (w.out[i].t_ns == next_ns) {
			next_ns += PERIOD;
		} else {
			extra++;
		}
	}
	assert_int_equal(next_ns, T0 + 6 * CLOCK_NS_PER_S + PERIOD);
	assert_int_equal(extra, 4); /* armed, warning, full, inhibited */
	assert_int_equal(pipeline_stats(w.p)->period_miss, 0);
	assert_int_equal(pipeline_stats(w.p)->sent, w.n_out);
	end();
}

static void test_slower_messages(void **arg)
{
	static const enum publish_msg slow[] = {PUBLISH_STATUS, PUBLISH_TIMING};

	(void)arg;
	begin(&log_ops, 0, NULL);
	run_to(T0 + CLOCK_NS_PER_S);
	for (int k = 0; k < 2; k++) {
		int64_t next_ns = T0;

		for (int i = 0; i < w.n_out; i++) {
			if (w.out[i].id == 0x2A0u + slow[k]) {
				assert_int_equal(w.out[i].t_ns, next_ns);
				next_ns += 100 * MS;
			}
		}
		assert_int_equal(next_ns, T0 + 1100 * MS);
	}
	assert_int_equal(count(PUBLISH_RISK), 20);
	assert_int_equal(count(PUBLISH_MARGIN), 20);
	end();
}

/* ---- evaluation ---------------------------------------------------------------------------------------- */

static void test_one_evaluation_per_scan(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	w.risk[FUTURE_DEFER] = 0.01;
	run_scans(7);
	w.risk[FUTURE_DEFER] = 0.001;
	run_scans(20);
	assert_int_equal(pipeline_stats(w.p)->scans, 20);
	assert_int_equal(pipeline_stats(w.p)->frames, 21);
	assert_int_equal(pipeline_stats(w.p)->evaluations, 20);
	assert_int_equal(pipeline_stats(w.p)->skipped, 0);
	assert_true(pipeline_stats(w.p)->risk_max == 0.01);
	assert_int_equal(pipeline_rejected(w.p)[SCENE_REJECT_CRC], 21);
	assert_int_equal(w.runs, 20);
	assert_int_equal(w.cycles, 20);
	assert_int_equal(w.cycle.id, 20);
	assert_int_equal(w.cycle.scene.scan, 20);
	assert_true(w.cycle.req.mean[MODEL_HEADWAY] == 60);
	assert_true(w.cycle.res.risk[FUTURE_DEFER].p == 0.001);
	assert_int_equal(w.cycle.t_ns[EDGE_INPUT], w.now_ns - 30 * MS);
	assert_int_equal(w.cycle.t_ns[EDGE_DECIDE], w.now_ns);
	assert_int_equal(raw(last(PUBLISH_RISK), AEB_RISK_EVAL_ID), 20);
	end();
}

static void test_silence_ends_a_scan(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	w.scan_id = ID_OPENS;
	run_to(SCAN_0 + 12 * MS);
	assert_int_equal(w.now_ns, SCAN_0 + 12 * MS);
	assert_int_equal(pipeline_stats(w.p)->scans, 1);
	assert_int_equal(pipeline_stats(w.p)->evaluations, 1);
	end();
}

static void test_brakes_and_releases(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	run_scans(20);
	assert_int_equal(w.changes, 1); /* armed */
	dangerous_scene();
	run_scans(21);
	request_is("ARMED", "warn", "none");
	assert_int_equal(last(PUBLISH_REQUEST)->t_ns, w.scan_ns); /* at once */
	run_scans(22);
	request_is("BRAKE", "full", "brake");
	assert_int_equal(last(PUBLISH_REQUEST)->t_ns, w.scan_ns);
	assert_int_equal(raw(last(PUBLISH_REQUEST), AEB_REQUEST_DECEL), 120);
	assert_int_equal(raw(last(PUBLISH_REQUEST), AEB_REQUEST_P_COLLISION), 57600);
	assert_int_equal(raw(last(PUBLISH_REQUEST), AEB_REQUEST_TTL), 150);
	assert_int_equal(raw(last(PUBLISH_REQUEST), AEB_REQUEST_EVAL_ID), 22);
	assert_int_equal(w.changes, 3);
	assert_int_equal(w.change.dec.level, LEVEL_FULL);
	assert_int_equal(w.change.state, STATE_BRAKE);
	assert_int_equal(w.cycle.dec.level, LEVEL_FULL);
	run_to(w.scan_ns + 25 * MS);
	assert_int_equal(raw(last(PUBLISH_REQUEST), AEB_REQUEST_TTL), 125);
	run_scans(40);
	request_is("BRAKE", "full", "brake");
	safe_scene();
	run_scans(43);
	request_is("BRAKE", "full", "brake");
	run_scans(44);
	request_is("ARMED", "none", "none");
	assert_int_equal(w.changes, 4);
	assert_int_equal(pipeline_decision(w.p)->entered[LEVEL_FULL], 1);
	assert_int_equal(pipeline_decision(w.p)->entered[LEVEL_WARN], 1);
	end();
}

/* While we brake, futures begin with the ego's motion without us; the scene stays as it was measured. */
static void test_futures_begin_without_our_braking(void **arg)
{
	const float *factor = w.cycle.req.factor;

	(void)arg;
	begin(&log_ops, 0, NULL);
	run_scans(20);
	dangerous_scene();
	w.scene.x[SCENE_EGO_ACCEL] = -2;
	w.scene.cov[SCENE_EGO_ACCEL][SCENE_EGO_SPEED] = 0.005;
	w.scene.cov[SCENE_EGO_SPEED][SCENE_EGO_ACCEL] = 0.005;
	run_scans(22);
	assert_int_equal(w.cycle.dec.level, LEVEL_FULL);
	assert_true(w.cycle.req.mean[MODEL_EGO_ACCEL] == -2 && factor[4] > 0 && factor[5] > 0);
	run_scans(23);
	assert_true(w.cycle.req.mean[MODEL_EGO_ACCEL] == 0);
	assert_true(factor[3] == 0 && factor[4] == 0 && factor[5] == 0);
	assert_true(w.cycle.scene.x[SCENE_EGO_ACCEL] == -2);
	assert_true(w.cycle.scene.cov[SCENE_EGO_ACCEL][SCENE_EGO_ACCEL] == 0.01);
	end();
}

static void test_no_lead_is_not_no_risk(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	run_scans(10);
	assert_true(has_risk());
	w.scene.lead_valid = 0;
	run_scans(20);
	run_to(w.now_ns + PERIOD);
	assert_int_equal(w.runs, 10);
	assert_int_equal(pipeline_stats(w.p)->evaluations, 10);
	assert_int_equal(w.cycles, 10);
	request_is("ARMED", "none", "none");
	assert_false(has_risk());
	assert_true(raw(last(PUBLISH_REQUEST), AEB_REQUEST_TTL) > 0); /* scans do come */
	assert_int_equal(count(PUBLISH_RISK), 20);
	assert_int_equal(raw(last(PUBLISH_RISK), AEB_RISK_P_HIGH), AEB_RISK_P_HIGH_NOT_AVAILABLE);
	assert_int_equal(raw(last(PUBLISH_MARGIN), AEB_MARGIN_TTC), AEB_MARGIN_TTC_NOT_AVAILABLE);
	w.scene.lead_valid = 1;
	run_scans(21);
	run_to(w.now_ns + PERIOD);
	assert_true(has_risk());
	assert_int_equal(raw(last(PUBLISH_REQUEST), AEB_REQUEST_EVAL_ID), 11);
	end();
}

/* ---- what inhibits -------------------------------------------------------------------------------------- */

static void test_radar_silence_inhibits(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	dangerous_scene();
	run_scans(10);
	request_is("BRAKE", "full", "brake");
	w.radar = 0;
	run_to(w.scan_ns + 145 * MS);
	request_is("BRAKE", "full", "brake");
	run_to(w.scan_ns + 150 * MS + 1); /* on no period */
	assert_int_equal(w.now_ns, w.scan_ns + 150 * MS + 1);
	request_is("INHIBIT", "none", "none");
	assert_false(has_risk());
	assert_int_equal(raw(last(PUBLISH_REQUEST), AEB_REQUEST_TTL), 0);
	assert_int_equal(w.change.dec.cause, CAUSE_INHIBITED);
	run_to(w.now_ns + CLOCK_NS_PER_S);
	assert_int_equal(reasons(), FAULT_BIT(RADAR_STALE));
	request_is("INHIBIT", "none", "none");

	safe_scene();
	w.radar = 1;
	w.next_scan_ns = w.now_ns + 5 * MS;
	run_to(w.now_ns + 600 * MS);
	request_is("INHIBIT", "none", "none"); /* held for 700 ms */
	assert_false(has_risk());
	run_to(w.now_ns + 200 * MS);
	request_is("ARMED", "none", "none");
	assert_true(has_risk());
	end();
}

/* Said when it happens, once, and the period goes on as it was. */
static void test_an_input_goes_stale_between_periods(void **arg)
{
	int sent;

	(void)arg;
	begin(&log_ops, 0, NULL);
	dangerous_scene();
	run_scans(10);
	w.radar = 0;
	run_to(T0 + 25 * PERIOD);
	request_is("BRAKE", "full", "brake");
	sent = count(PUBLISH_REQUEST);
	w.stale_ns = w.now_ns + 7 * MS;
	run_to(w.stale_ns);
	assert_int_equal(w.now_ns, w.stale_ns);
	request_is("INHIBIT", "none", "none");
	assert_int_equal(pipeline_now(w.p)->fault, FAULT_BIT(EGO_STALE));
	assert_int_equal(count(PUBLISH_REQUEST), sent + 1);
	run_to(T0 + 30 * PERIOD);
	assert_int_equal(count(PUBLISH_REQUEST), sent + 6);
	assert_int_equal(pipeline_stats(w.p)->period_miss, 0);
	end();
}

/* Nothing is said of an input that goes stale while another already is. */
static void test_a_second_stale_input_is_no_news(void **arg)
{
	int sent;

	(void)arg;
	begin(&log_ops, 0, NULL);
	run_scans(10);
	w.radar = 0;
	run_to(w.scan_ns + 150 * MS + 1);
	request_is("INHIBIT", "none", "none");
	run_to(T0 + 35 * PERIOD);
	sent = count(PUBLISH_REQUEST);
	w.stale_ns = w.now_ns + 7 * MS;
	run_to(w.stale_ns);
	assert_int_equal(w.now_ns, w.stale_ns);
	assert_int_equal(count(PUBLISH_REQUEST), sent);
	end();
}

static void test_input_fault_inhibits(void **arg)
{
	int runs;

	(void)arg;
	begin(&log_ops, 0, NULL);
	dangerous_scene();
	run_scans(10);
	w.scene.fault = FAULT_BIT(IMPLAUSIBLE);
	runs = w.runs;
	run_scans(11);
	request_is("INHIBIT", "none", "none");
	run_scans(30);
	request_is("INHIBIT", "none", "none");
	assert_false(has_risk());
	assert_int_equal(raw(last(PUBLISH_RISK), AEB_RISK_P_HIGH), AEB_RISK_P_HIGH_NOT_AVAILABLE);
	assert_int_equal(w.runs, runs); /* what cannot be trusted is not computed with */
	end();
}

static void test_invalid_ego_is_no_evaluation(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	w.scene.ego_valid = 0;
	run_scans(5);
	assert_int_equal(w.runs, 0);
	assert_false(has_risk());
	request_is("ARMED", "none", "none");
	end();
}

static void test_refused_frames_inhibit(void **arg)
{
	uint64_t sent;

	(void)arg;
	begin(&log_ops, 0, NULL);
	run_scans(5);
	sent = pipeline_stats(w.p)->sent;
	w.send_error = -ENOBUFS;
	run_to(w.now_ns + 100 * MS);
	assert_int_equal(pipeline_stats(w.p)->sent, sent);
	w.send_error = 0;
	run_to(w.now_ns + 100 * MS);
	request_is("INHIBIT", "none", "none");
	assert_true(reasons() & FAULT_BIT(TX_REFUSED));
	run_to(w.now_ns + 1100 * MS);
	request_is("ARMED", "none", "none");
	end();
}

static void test_bus_events(void **arg)
{
	static const struct {
		uint32_t event, fault;
	} row[] = {
		{BUS_EV_DOWN, FAULT_BIT(BUS_DOWN)},       {BUS_EV_OFF, FAULT_BIT(BUS_OFF)},
		{BUS_EV_FOREIGN, FAULT_BIT(FOREIGN_ID)},  {BUS_EV_STAMP, FAULT_BIT(CLOCK_STEP)},
		{BUS_EV_PASSIVE, FAULT_BIT(BUS_PASSIVE)}, {BUS_EV_OVERFLOW, FAULT_BIT(RX_LOST)},
	};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		begin(&live_ops, 0, NULL);
		run_scans(5);
		w.events = row[i].event;
		run_to(w.now_ns + 200 * MS);
		request_is(state_name[fault_state(row[i].fault)], "none", "none");
		assert_int_equal(reasons(), row[i].fault);
		end();
	}
}

/* ---- a loop that stood still ------------------------------------------------------------------------------ */

static void test_stall_distrusts_the_queue(void **arg)
{
	uint64_t scans;

	(void)arg;
	begin(&live_ops, 0, NULL);
	run_scans(5);
	run_to(SCAN_0 + 4 * SCAN + 15 * MS); /* at a period; the next event is another */
	scans = pipeline_stats(w.p)->scans;
	w.oversleep_ns = 64 * MS;
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(pipeline_stats(w.p)->period_miss,
			 3); /* three absent; the fourth in time */
	assert_int_equal(w.distrusted, 1);
	assert_int_equal(w.drained, 1);
	request_is("INHIBIT", "none", "none");
	assert_int_equal(pipeline_stats(w.p)->scans, scans);
	run_to(w.now_ns + PERIOD);
	assert_int_equal((w.now_ns - T0) % PERIOD, 0); /* the schedule is absolute */
	assert_int_equal(pipeline_stats(w.p)->period_miss, 3);
	end();
}

static void test_frames_of_a_stall_are_not_used(void **arg)
{
	(void)arg;
	begin(&live_ops, 0, NULL);
	run_scans(5);
	run_to(SCAN_0 + 4 * SCAN + 35 * MS); /* next: the scan, 5 ms before a period */
	w.oversleep_ns = 26 * MS;
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(pipeline_stats(w.p)->scans, 5);
	assert_int_equal(w.distrusted, 1);
	end();
}

static void test_late_period(void **arg)
{
	static const struct {
		int64_t late_ns;
		uint64_t missed;
	} row[] = {{5 * MS, 0}, {5 * MS + 1, 1}, {20 * MS, 1}, {26 * MS, 2}};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		begin(&live_ops, 0, NULL);
		assert_int_equal(pipeline_step(w.p), 0);
		w.oversleep_ns = row[i].late_ns;
		assert_int_equal(pipeline_step(w.p), 0);
		assert_int_equal(w.now_ns, T0 + PERIOD + row[i].late_ns);
		assert_int_equal(pipeline_stats(w.p)->period_miss, row[i].missed);
		assert_int_equal(w.distrusted, row[i].late_ns > PERIOD);
		end();
	}
}

/* ---- the backend's failures --------------------------------------------------------------------------------- */

static void expect_fallback(uint32_t fault)
{
	dangerous_scene();
	run_scans(11);
	request_is("DEGRADED", "warn", "none");
	run_scans(12);
	request_is("DEGRADED", "full", "brake");
	assert_int_equal(w.change.dec.cause, CAUSE_FALLBACK);
	assert_true(raw(last(PUBLISH_REQUEST), AEB_REQUEST_TTL) > 0); /* it is to be obeyed */
	assert_false(has_risk());
	run_scans(15);
	assert_int_equal(reasons(), fault);
	assert_int_equal(pipeline_stats(w.p)->evaluations, 10);
}

static void test_backend_error_falls_back(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	run_scans(10);
	w.run_error = -EIO;
	expect_fallback(FAULT_BIT(MC_ERROR));
	w.run_error = 0;
	run_scans(16); /* a result again: the risk decides, though the reason is held */
	run_to(w.now_ns + PERIOD);
	request_is("DEGRADED", "full", "brake");
	assert_true(has_risk());
	run_to(w.now_ns + 1100 * MS);
	request_is("BRAKE", "full", "brake");
	end();
}

static void test_foreign_result_is_wrong_memory(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	run_scans(10);
	w.wrong_hash = 1;
	run_scans(13);
	assert_int_equal(reasons(), FAULT_BIT(MEMORY));
	w.wrong_hash = 0;
	run_scans(40); /* for good */
	request_is("FAULT", "none", "none");
	assert_int_equal(pipeline_stats(w.p)->evaluations, 10);
	end();
}

static void test_impossible_request_is_an_error(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	run_scans(10);
	dangerous_scene();
	w.scene.cov[0][0] = -1;
	run_scans(11);
	request_is("DEGRADED", "warn", "none");
	w.scene.cov[0][0] = 0.01;
	w.scene.x[SCENE_EGO_ACCEL] = NAN; /* refused by the backend's own check */
	run_scans(12);
	request_is("DEGRADED", "full", "brake");
	assert_int_equal(w.runs, 10);
	end();
}

static void test_cut_batch(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	run_scans(10);
	w.res_flags = MC_RES_CUT;
	dangerous_scene();
	run_scans(12); /* enough samples: the risk decides */
	request_is("DEGRADED", "full", "brake");
	assert_int_equal(w.change.dec.cause, CAUSE_RISK);
	assert_true(has_risk());
	assert_int_equal(pipeline_stats(w.p)->late, 2);
	run_scans(14);
	assert_int_equal(reasons(), FAULT_BIT(MC_LATE));
	w.res_flags = 0;
	run_scans(15);
	request_is("BRAKE", "full", "brake");
	end();
}

/* ---- a worker that is slow ------------------------------------------------------------------------------------ */

static void test_newest_scan_waits(void **arg)
{
	(void)arg;
	begin(&log_ops, 1, NULL);
	__atomic_store_n(&w.block, 1, __ATOMIC_RELEASE);
	run_scans(3); /* the first is computed, the second gives way to the third */
	assert_int_equal(pipeline_stats(w.p)->skipped, 1);
	assert_int_equal(pipeline_stats(w.p)->evaluations, 0);
	run_to(w.now_ns + 30 * MS); /* nothing is spent waiting but 1 ms naps */
	w.risk[FUTURE_DEFER] = 0.25;
	let_one_pass();
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(pipeline_stats(w.p)->evaluations, 1);
	assert_int_equal(w.cycle.scene.scan, 1);
	assert_true(pipeline_stats(w.p)->risk_max == 0.25);
	let_one_pass();
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(pipeline_stats(w.p)->evaluations, 2);
	assert_int_equal(w.cycle.scene.scan, 3);
	assert_int_equal(pipeline_stats(w.p)->skipped, 1);
	assert_int_equal(pipeline_stats(w.p)->late, 0);
	end();
}

/* A result whose scan is past its TTL decides nothing; meanwhile the deterministic rule does. */
static void test_old_result_is_late(void **arg)
{
	(void)arg;
	begin(&log_ops, 1, NULL);
	__atomic_store_n(&w.block, 1, __ATOMIC_RELEASE);
	dangerous_scene();
	run_scans(4); /* 150 ms: still within its time */
	request_is("ARMED", "none", "none");
	run_scans(5);
	request_is("DEGRADED", "warn", "none");
	run_scans(6);
	request_is("DEGRADED", "full", "brake");
	assert_int_equal(w.change.dec.cause, CAUSE_FALLBACK);
	assert_false(has_risk());
	let_one_pass();
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(pipeline_stats(w.p)->late, 1);
	assert_int_equal(pipeline_stats(w.p)->evaluations, 0);
	assert_int_equal(w.cycles, 0);
	end();
}

static void test_deadline_cuts_the_batch(void **arg)
{
	(void)arg;
	begin(&log_ops, 1, NULL);
	__atomic_store_n(&w.block, 1, __ATOMIC_RELEASE);
	run_to(SCAN_0 + 529 * MS);
	assert_int_equal(__atomic_load_n(&w.cut_seen, __ATOMIC_ACQUIRE), 0);
	run_to(SCAN_0 + 530 * MS);
	assert_int_equal(w.now_ns, SCAN_0 + 530 * MS);
	await_result(); /* it obeyed */
	assert_int_equal(__atomic_load_n(&w.cut_seen, __ATOMIC_ACQUIRE), 1);
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(pipeline_stats(w.p)->late, 1);
	end();
}

static void test_deaf_worker_is_stuck(void **arg)
{
	(void)arg;
	begin(&live_ops, 1, NULL);
	w.deaf = 1;
	__atomic_store_n(&w.block, 1, __ATOMIC_RELEASE);
	assert_int_equal(w.watched_fd, mc_eventfd(w.mc));
	run_to(SCAN_0 + 670 * MS);
	assert_false(reasons() & FAULT_BIT(MC_STUCK));
	run_to(SCAN_0 + 900 * MS);
	assert_true(reasons() & FAULT_BIT(MC_STUCK));
	request_is("DEGRADED", "none", "none");
	assert_int_equal(pipeline_stats(w.p)->period_miss, 0);
	let_one_pass();
	run_to(w.now_ns + SCAN);
	assert_int_equal(pipeline_stats(w.p)->late, 1);
	end();
}

/* ---- what other threads hand over ------------------------------------------------------------------------------ */

static void test_backend_comes_late(void **arg)
{
	(void)arg;
	begin(&live_ops, 1, NULL);
	struct pipeline_open o = options(NULL);

	o.mc = NULL;
	w.watched_fd = -1;
	reopen(&o);
	run_scans(10);
	request_is("INIT", "none", "none");
	assert_false(has_risk());
	run_scans(12);
	assert_int_equal(reasons(), FAULT_BIT(STARTING));
	assert_int_equal(w.watched_fd, -1);
	pipeline_set_mc(w.p, w.mc, PUBLISH_BACKEND_GPU, 65536);
	run_scans(13);
	request_is("ARMED", "none", "none");
	assert_int_equal(w.watched_fd, mc_eventfd(w.mc));
	run_scans(20);
	assert_int_equal(raw(last(PUBLISH_STATUS), AEB_STATUS_BACKEND), AEB_STATUS_BACKEND_GPU);
	assert_int_equal(pipeline_stats(w.p)->samples, 65536);
	end();
}

/* The batch of a backend that is replaced is never waited for. */
static void test_backend_is_replaced(void **arg)
{
	const struct mc_params params = {.n_resident = 256, .threads = 1};
	struct mc *other = NULL;

	(void)arg;
	begin(&log_ops, 1, NULL);
	assert_int_equal(mc_open(&fake_ops, &params, 0, &other), 0);
	__atomic_store_n(&w.block, 1, __ATOMIC_RELEASE);
	w.deaf = 1;
	run_scans(3);
	assert_int_equal(pipeline_stats(w.p)->evaluations, 0);
	let_one_pass(); /* the result lies ready, but is not asked for */
	__atomic_store_n(&w.block, 0, __ATOMIC_RELEASE);
	pipeline_set_mc(w.p, other, PUBLISH_BACKEND_CPU, 256);
	run_scans(6);
	assert_true(pipeline_stats(w.p)->evaluations >= 3);
	assert_int_equal(w.cycle.scene.scan, 6);
	end();
	mc_close(other);
}

/* A second backend that never fails, while w.run_error and w.block are the first one's. */
static int spare_run(struct mc_backend *b, const struct mc_request *req, const uint64_t *cut,
		     struct mc_result *res)
{
	(void)b;
	(void)cut;
	*res = (struct mc_result){
		.id = req->id, .req_hash = mc_request_hash(req), .n = w.n, .n_futures = FUTURES};
	return 0;
}

static const struct mc_ops spare_ops = {
	.name = "spare", .open = fake_open, .run = spare_run, .close = fake_close};

static void expect_spare(uint32_t fault, uint64_t before)
{
	assert_int_equal(reasons(), fault);
	request_is("DEGRADED", "none", "none");
	assert_true(has_risk());
	assert_true(pipeline_stats(w.p)->evaluations >= before + 3);
	assert_int_equal(raw(last(PUBLISH_STATUS), AEB_STATUS_BACKEND), AEB_STATUS_BACKEND_CPU);
	assert_int_equal(w.cycle.req.n, 1024);
}

static void test_spare_takes_over_after_an_error(void **arg)
{
	static const struct {
		int err;
		uint32_t fault;
	} row[] = {{-EFAULT, FAULT_BIT(GPU_ADDRESS)},
		   {-EIO, FAULT_BIT(GPU_LOST)},
		   {-EBADMSG, FAULT_BIT(GPU_BITS)},
		   {-ETIMEDOUT, FAULT_BIT(GPU_HANG)},
		   {0, FAULT_BIT(GPU_BITS)}}; /* 0: the result of another request */
	const struct mc_params params = {.n_resident = 256, .threads = 1};

	(void)arg;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct mc *spare = NULL;

		assert_int_equal(mc_open(&spare_ops, &params, MC_INLINE, &spare), 0);
		begin(&log_ops, 0, NULL);
		pipeline_set_spare(w.p, spare, 1024);
		run_scans(10);
		w.run_error = row[i].err;
		w.wrong_hash = row[i].err == 0;
		run_scans(40);
		expect_spare(row[i].fault, 10);
		w.run_error = w.wrong_hash = 0;
		end();
		mc_close(spare);
	}
}

/* What no backend would take is no reason to give one up. */
static void test_impossible_request_keeps_the_backend(void **arg)
{
	const struct mc_params params = {.n_resident = 256, .threads = 1};
	struct mc *spare = NULL;

	(void)arg;
	assert_int_equal(mc_open(&spare_ops, &params, MC_INLINE, &spare), 0);
	begin(&log_ops, 0, NULL);
	pipeline_set_spare(w.p, spare, 1024);
	run_scans(10);
	w.scene.cov[0][0] = -1;
	run_scans(13);
	assert_int_equal(reasons(), FAULT_BIT(MC_ERROR));
	assert_int_equal(w.runs, 10);
	w.scene.cov[0][0] = 0.01;
	run_scans(14);
	assert_int_equal(w.runs, 11);
	end();
	mc_close(spare);
}

/* Wrong bits on the GPU, then on the CPU: nothing is left that could be believed. */
static void test_wrong_bits_twice_are_a_fault(void **arg)
{
	const struct mc_params params = {.n_resident = 256, .threads = 1};
	struct mc *spare = NULL;

	(void)arg;
	assert_int_equal(mc_open(&fake_ops, &params, MC_INLINE, &spare), 0);
	begin(&log_ops, 0, NULL);
	pipeline_set_spare(w.p, spare, 1024);
	run_scans(10);
	w.run_error = -EBADMSG;
	run_scans(11);
	assert_int_equal(pipeline_now(w.p)->fault, FAULT_BIT(GPU_BITS));
	run_scans(14);
	assert_int_equal(reasons(), FAULT_BIT(GPU_BITS) | FAULT_BIT(MEMORY));
	request_is("FAULT", "none", "none");
	w.run_error = 0;
	end();
	mc_close(spare);
}

static void test_spare_takes_over_from_a_stuck_backend(void **arg)
{
	const struct mc_params params = {.n_resident = 256, .threads = 1};
	struct mc *spare = NULL;

	(void)arg;
	assert_int_equal(mc_open(&spare_ops, &params, MC_INLINE, &spare), 0);
	begin(&live_ops, 1, NULL);
	pipeline_set_spare(w.p, spare, 1024);
	w.deaf = 1;
	__atomic_store_n(&w.block, 1, __ATOMIC_RELEASE);
	run_to(SCAN_0 + 1900 * MS);
	expect_spare(FAULT_BIT(GPU_HANG), 0);
	assert_int_equal(pipeline_stats(w.p)->period_miss, 0);
	__atomic_store_n(&w.block, 0, __ATOMIC_RELEASE);
	end();
	mc_close(spare);
}

static void test_arming(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	struct pipeline_open o = options(NULL);

	o.needs_arm = 1;
	reopen(&o);
	dangerous_scene();
	run_scans(10);
	request_is("BRAKE", "full", "none"); /* decided, not asked for */
	assert_int_equal(raw(last(PUBLISH_REQUEST), AEB_REQUEST_DECEL), 0);
	assert_false(pipeline_armed(w.p));
	pipeline_arm(w.p, 1);
	run_scans(11);
	run_to(w.now_ns + PERIOD);
	request_is("BRAKE", "full", "brake");
	assert_true(pipeline_armed(w.p));
	pipeline_arm(w.p, 0);
	run_to(w.now_ns + PERIOD);
	request_is("BRAKE", "full", "none");
	pipeline_arm(w.p, 1);
	w.scene.fault = FAULT_BIT(MEMORY);
	run_to(w.now_ns + 100 * MS);
	request_is("FAULT", "none", "none");
	assert_false(pipeline_armed(w.p));
	end();
}

static void test_quiet_sends_nothing(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	struct pipeline_open o = options(NULL);

	o.quiet = 1;
	reopen(&o);
	dangerous_scene();
	run_scans(10);
	assert_int_equal(w.n_out, 0);
	assert_int_equal(pipeline_stats(w.p)->sent, 0);
	assert_int_equal(pipeline_stats(w.p)->evaluations, 10);
	assert_int_equal(pipeline_now(w.p)->dec.level, LEVEL_FULL);
	assert_int_equal(pipeline_now(w.p)->state, STATE_BRAKE);
	end();
}

static void test_new_configuration(void **arg)
{
	struct config other;

	(void)arg;
	begin(&log_ops, 0, NULL);
	dangerous_scene();
	w.risk[FUTURE_DEFER] = 0.3;
	other = w.cfg;
	other.decision_p_defer = 0.2;
	w.cfg.decision_p_defer = 0.4;
	run_scans(10);
	request_is("ARMED", "warn", "none");
	pipeline_mark(w.p); /* without a recorder: nothing */
	pipeline_set_config(w.p, &other);
	run_scans(11);
	request_is("BRAKE", "full", "brake");
	end();
}

static void test_configuration_that_changes_by_itself(void **arg)
{
	struct config other;
	uint16_t hash;

	(void)arg;
	begin(&log_ops, 0, NULL);
	run_scans(4);
	hash = pipeline_now(w.p)->hash;
	other = w.cfg;
	other.decision_p_defer = 0.2;
	pipeline_set_config(w.p, &other);
	pipeline_check_config(w.p);
	run_scans(8);
	request_is("ARMED", "none", "none");
	assert_int_not_equal(pipeline_now(w.p)->hash,
			     hash); /* the frames say which one is in force */
	other.decision_p_defer = 0.1;
	pipeline_check_config(w.p);
	run_scans(12);
	assert_int_equal(reasons(), FAULT_BIT(CONFIG));
	request_is("FAULT", "none", "none");
	end();
}

static void test_last_frames(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	dangerous_scene();
	run_scans(10);
	request_is("BRAKE", "full", "brake");
	pipeline_finish(w.p);
	request_is("INHIBIT", "none", "none");
	assert_false(has_risk());
	assert_int_equal(raw(last(PUBLISH_REQUEST), AEB_REQUEST_TTL), 0);
	assert_int_equal(raw(last(PUBLISH_STATUS), AEB_STATUS_STATE), AEB_STATUS_STATE_INHIBIT);
	end();
}

/* ---- times ------------------------------------------------------------------------------------------------------ */

static const struct bus_frame *last_times(void)
{
	for (int i = w.n_out - 1; i >= 0; i--) {
		if (w.out[i].id == 0x2A0u + PUBLISH_TIMING &&
		    raw(&w.out[i], AEB_TIMING_PAGE) == AEB_TIMING_PAGE_TIMES) {
			return &w.out[i];
		}
	}
	fail_msg("no times");
	return NULL;
}

static void test_no_clock_no_times(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	run_scans(20);
	assert_int_equal(raw(last_times(), AEB_TIMING_INPUT_AGE), 30);
	assert_int_equal(raw(last_times(), AEB_TIMING_MC_TIME), AEB_TIMING_MC_TIME_NOT_AVAILABLE);
	assert_int_equal(raw(last_times(), AEB_TIMING_TOTAL_TIME),
			 AEB_TIMING_TOTAL_TIME_NOT_AVAILABLE);
	assert_int_equal(pipeline_stats(w.p)->stage_miss, 0);
	end();
}

static void test_clock_stamps_the_edges(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, fake_clock);
	run_scans(20);
	assert_int_equal(raw(last_times(), AEB_TIMING_MC_TIME), 5); /* 1 ms in steps of 0.2 */
	assert_true(raw(last_times(), AEB_TIMING_DECISION_TIME) !=
		    AEB_TIMING_DECISION_TIME_NOT_AVAILABLE);
	end();
}

static void test_stage_miss(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	w.scene.oldest_input_ns = 120 * MS;
	run_scans(5);
	run_to(w.now_ns + PERIOD);
	assert_int_equal(pipeline_stats(w.p)->stage_miss, 0);
	w.scene.oldest_input_ns = 121 * MS;
	run_scans(8);
	run_to(w.now_ns + PERIOD);
	assert_int_equal(pipeline_stats(w.p)->stage_miss, 3);
	end();
}

/* ---- stages, misses and the tracer ------------------------------------------------------------------------------- */

static void tell_edge(uint64_t cycle, enum edge e, int64_t t_ns)
{
	struct told *t = &w.told;

	if (e == EDGE_INPUT) {
		t->id = cycle;
		memset(t->t_ns, 0, sizeof(t->t_ns));
	}
	t->edges[e]++;
	if (cycle != t->id) {
		return;
	}
	t->t_ns[e] = t_ns;
	for (int s = 0; s < STAGES; s++) {
		const int64_t ns = stage_table[s].to == e ? stage_ns((enum stage)s, t->t_ns) : -1;

		if (ns >= 0) {
			hist_add(&t->hist[s], ns);
		}
	}
}

static void tell_miss(uint64_t cycle, const char *kind, const char *stage, uint64_t count,
		      int64_t late_ns)
{
	for (int k = 0; k < MISSES; k++) {
		w.told.misses[k] += strcmp(kind, miss_name[k]) ? 0 : count;
	}
	if (!strcmp(kind, "stage")) {
		snprintf(w.told.stage, sizeof(w.told.stage), "%s", stage);
	}
	w.told.cycle = cycle;
	w.told.late_ns = late_ns;
}

static void tell_fault(const char *reason, int on)
{
	(void)reason;
	w.told.faults += on;
}

static void tell_state(const char *from, const char *to)
{
	assert_string_not_equal(from, to);
	w.told.states++;
}

static void tell_evaluation(const struct trace_evaluation *e)
{
	w.told.evaluations++;
	w.told.evaluation = *e;
}

static void tell_clock(const struct trace_clock *c)
{
	assert_int_equal(c->period_ns, PERIOD);
	assert_int_equal(c->live, 0);
	assert_int_equal(c->mono_ns, w.now_ns);
	w.told.clocks++;
}

static void tell_published(uint64_t n, int64_t due_ns, int64_t late_ns, int missed)
{
	assert_int_equal(n, ++w.told.published);
	assert_int_equal((due_ns - T0) % PERIOD, 0);
	assert_int_equal(due_ns + late_ns, w.now_ns);
	assert_int_equal(missed, late_ns > PERIOD / 4);
}

static const struct trace_ops tell = {.edge = tell_edge,
				      .miss = tell_miss,
				      .fault = tell_fault,
				      .state = tell_state,
				      .evaluation = tell_evaluation,
				      .clock = tell_clock,
				      .published = tell_published};

static void begin_traced(const struct bus_ops *ops, int worker, int64_t (*clock)(void))
{
	begin(ops, worker, clock);
	struct pipeline_open o = options(clock);

	o.trace = &tell;
	reopen(&o);
}

/* What the tracer is told and what is counted without one are the same. */
static void counts_agree(void)
{
#ifdef TRACE_PROVIDERS
	const struct pipeline_stats *s = pipeline_stats(w.p);
	const uint64_t counted[MISSES] = {[MISS_STAGE] = s->stage_miss,
					  [MISS_LATE] = s->late,
					  [MISS_PERIOD] = s->period_miss,
					  [MISS_SKIPPED] = s->skipped};

	assert_memory_equal(w.told.misses, counted, sizeof(counted));
	assert_memory_equal(w.told.hist, pipeline_hist(w.p), sizeof(w.told.hist));
#endif
}

static void needs_trace(void)
{
#ifndef TRACE_PROVIDERS
	print_message("# needs lttng: no tracer is built in, its events are compiled to nothing\n");
	skip();
#endif
}

static void test_a_drive_is_told(void **arg)
{
	(void)arg;
	needs_trace();
	begin_traced(&log_ops, 0, NULL);
	run_scans(30);
	dangerous_scene();
	run_scans(60);
	assert_int_equal(w.told.evaluations, 60);
	assert_int_equal(w.told.edges[EDGE_INPUT], 60);
	assert_int_equal(w.told.edges[EDGE_DECIDE], 60);
	assert_int_equal(w.told.edges[EDGE_SEND], 59);
	assert_int_equal(w.told.edges[EDGE_CONFIRM], 0);
	assert_int_equal(w.told.clocks, 3);
	assert_int_equal(w.told.published, (w.now_ns - T0) / PERIOD + 1);
	assert_int_equal(w.told.faults, 1);
	assert_int_equal(w.told.states, 2); /* armed, brake */
	assert_int_equal(w.told.evaluation.cycle, 60);
	assert_string_equal(w.told.evaluation.level, "full");
	assert_string_equal(w.told.evaluation.state, "BRAKE");
	assert_true(w.told.evaluation.p == 0.9 && w.told.evaluation.headway_m == 8);
	counts_agree();
	end();
}

/* The echo of the frame that carried the decision, not of any frame. */
static void test_confirmed_by_its_echo(void **arg)
{
	(void)arg;
	begin_traced(&echo_ops, 0, NULL);
	run_scans(3);
	assert_int_equal(w.cycle.t_ns[EDGE_CONFIRM], 0);
	run_to(w.now_ns + PERIOD);
	assert_int_equal(w.expected.id, 0x2A0);
	assert_int_equal(raw(&w.expected, AEB_REQUEST_EVAL_ID), 3);
	assert_int_equal(hist_count(&pipeline_hist(w.p)[STAGE_TOTAL]), 0);
	const int64_t sent_ns = w.expected.t_ns;

	w.echo_ns = sent_ns + MS;
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(hist_count(&pipeline_hist(w.p)[STAGE_TOTAL]), 1);
	assert_int_equal(hist_max_ns(&pipeline_hist(w.p)[STAGE_CONFIRM]), MS);
	assert_int_equal(hist_max_ns(&pipeline_hist(w.p)[STAGE_TOTAL]),
			 sent_ns + MS - (SCAN_0 + 2 * SCAN - 30 * MS));
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(hist_count(&pipeline_hist(w.p)[STAGE_TOTAL]), 1); /* once */
	run_scans(4);
	run_to(w.now_ns + PERIOD);
	assert_int_equal(raw(&w.expected, AEB_REQUEST_EVAL_ID), 4);
	w.echo_ns = w.expected.t_ns - MS; /* stamped by the kernel before send() returned */
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(hist_count(&pipeline_hist(w.p)[STAGE_TOTAL]), 2);
	assert_int_equal(pipeline_stats(w.p)->stage_miss, 0);
	counts_agree();
	end();
}

static void test_end_to_end_miss(void **arg)
{
	(void)arg;
	begin_traced(&echo_ops, 0, NULL);
	run_scans(3);
	run_to(w.now_ns + PERIOD);
	w.echo_ns = SCAN_0 + 2 * SCAN - 30 * MS + 700 * MS + 1;
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(pipeline_stats(w.p)->stage_misses[STAGE_TOTAL], 1);
	assert_int_equal(pipeline_stats(w.p)->stage_miss, 1);
	counts_agree();
	end();
}

/* A request frame that the bus refused carries nothing. */
static void test_refused_frame_sends_nothing(void **arg)
{
	(void)arg;
	begin(&echo_ops, 0, NULL);
	run_scans(3);
	assert_int_equal(hist_count(&pipeline_hist(w.p)[STAGE_SEND]), 2);
	w.send_error = -ENOBUFS;
	run_to(w.now_ns + PERIOD);
	assert_int_equal(hist_count(&pipeline_hist(w.p)[STAGE_SEND]), 2);
	w.send_error = 0;
	run_to(w.now_ns + PERIOD);
	assert_int_equal(hist_count(&pipeline_hist(w.p)[STAGE_SEND]), 3);
	end();
}

/* 600 ms of a stalled worker: one stage miss, one late result, the scans between it and the newest skipped. */
static void test_stalled_worker(void **arg)
{
	(void)arg;
	begin_traced(&log_ops, 1, NULL);
	w.deaf = 1;
	__atomic_store_n(&w.block, 1, __ATOMIC_RELEASE);
	run_to(SCAN_0 + 600 * MS);
	__atomic_store_n(&w.block, 0, __ATOMIC_RELEASE);
	let_one_pass();
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(pipeline_stats(w.p)->stage_miss, 1);
	assert_int_equal(pipeline_stats(w.p)->stage_misses[STAGE_MC], 1);
	assert_int_equal(pipeline_stats(w.p)->late, 1);
	assert_in_range(pipeline_stats(w.p)->skipped, 10, 12);
	assert_int_equal(pipeline_stats(w.p)->period_miss, 0);
#ifdef TRACE_PROVIDERS
	assert_string_equal(w.told.stage, "mc");
#endif
	counts_agree();
	end();
}

static void test_missed_periods_are_told(void **arg)
{
	(void)arg;
	needs_trace();
	begin_traced(&live_ops, 0, NULL);
	run_scans(5);
	run_to(SCAN_0 + 4 * SCAN + 15 * MS);
	w.oversleep_ns = 580 * MS;
	assert_int_equal(pipeline_step(w.p), 0);
	assert_in_range(w.told.misses[MISS_PERIOD], 28, 30);
	run_to(w.now_ns + 300 * MS);
	counts_agree();
	end();
}

static void test_timing_says_which_stage(void **arg)
{
	uint64_t misses = 0, max = 0;

	(void)arg;
	begin(&log_ops, 0, NULL);
	w.scene.oldest_input_ns = 121 * MS;
	run_scans(20);
	for (int i = 0; i < w.n_out; i++) {
		if (w.out[i].id != 0x2A0u + PUBLISH_TIMING) {
			continue;
		}
		if (raw(&w.out[i], AEB_TIMING_PAGE) == AEB_TIMING_PAGE_MISSES_BY_STAGE) {
			misses = raw(&w.out[i], AEB_TIMING_INPUT_MISSES);
			assert_int_equal(raw(&w.out[i], AEB_TIMING_MC_MISSES), 0);
		} else if (raw(&w.out[i], AEB_TIMING_PAGE) == AEB_TIMING_PAGE_LONGEST) {
			max = raw(&w.out[i], AEB_TIMING_INPUT_MAX);
			assert_int_equal(raw(&w.out[i], AEB_TIMING_MC_MAX),
					 AEB_TIMING_MC_MAX_NOT_AVAILABLE); /* a log's time */
		}
	}
	assert_true(misses > 5);
	assert_int_equal(max, 121);
	end();
}

/* ---- what the recorder is told --------------------------------------------------------------------------------- */

static void open_recorded(struct mc *mc)
{
	struct pipeline_open o = options(NULL);

	kept = (struct recorder){0};
	o.recorder = &kept;
	o.mc = mc;
	reopen(&o);
}

static void begin_recorded(const struct bus_ops *ops, int worker)
{
	begin(ops, worker, NULL);
	open_recorded(w.mc);
}

static void triggers_are(int warn, int request, int fault, int miss, int mark)
{
	const int want[RECORDER_REASONS] = {[RECORDER_WARN] = warn,
					    [RECORDER_REQUEST] = request,
					    [RECORDER_FAULT] = fault,
					    [RECORDER_MISS] = miss,
					    [RECORDER_MARK] = mark};

	assert_memory_equal(kept.triggers, want, sizeof(want));
}

static void test_levels_and_marks_are_recorded(void **arg)
{
	(void)arg;
	begin_recorded(&log_ops, 0);
	run_scans(5);
	triggers_are(0, 0, 0, 0, 0);
	assert_int_equal(kept.frames, 6);
	assert_int_equal(kept.evaluations, 5);
	pipeline_mark(w.p);
	run_scans(6);
	triggers_are(0, 0, 0, 0, 1);
	dangerous_scene();
	run_scans(7);
	triggers_are(1, 0, 0, 0, 1);
	assert_int_equal(kept.t_ns, w.now_ns);
	run_scans(8);
	triggers_are(1, 1, 0, 0, 1);
	safe_scene();
	run_scans(60); /* down again is no event */
	request_is("ARMED", "none", "none");
	triggers_are(1, 1, 0, 0, 1);
	end();
}

static void test_misses_of_stages_and_periods_are_recorded(void **arg)
{
	(void)arg;
	begin_recorded(&log_ops, 0);
	w.scene.oldest_input_ns = 121 * MS;
	run_scans(1);
	assert_int_equal(pipeline_stats(w.p)->stage_miss, 1);
	triggers_are(0, 0, 0, 0, 0); /* INIT */
	run_scans(4);
	run_to(w.now_ns + PERIOD);
	assert_int_equal(pipeline_stats(w.p)->stage_miss, 4);
	triggers_are(0, 0, 0, 3, 0);
	end();

	begin_recorded(&live_ops, 0);
	run_scans(5);
	run_to(SCAN_0 + 4 * SCAN + 15 * MS);
	w.oversleep_ns = 6 * MS;
	run_to(w.now_ns + PERIOD);
	assert_int_equal(pipeline_stats(w.p)->period_miss, 1);
	triggers_are(0, 0, 0, 1, 0);
	end();
}

static void test_late_and_skipped_are_recorded(void **arg)
{
	const struct pipeline_stats *s;

	(void)arg;
	begin_recorded(&log_ops, 1);
	w.deaf = 1;
	__atomic_store_n(&w.block, 1, __ATOMIC_RELEASE);
	run_to(SCAN_0 + 600 * MS);
	s = pipeline_stats(w.p);
	assert_in_range(s->skipped, 10, 12);
	triggers_are(0, 0, 1, (int)s->skipped, 0); /* MC_LATE */
	__atomic_store_n(&w.block, 0, __ATOMIC_RELEASE);
	let_one_pass();
	assert_int_equal(pipeline_step(w.p), 0);
	assert_int_equal(s->stage_miss, 1);
	assert_int_equal(s->late, 1);
	triggers_are(0, 0, 1, (int)s->skipped + 2, 0);
	end();
}

/* Whatever state it leads to, once, also while another one stands. */
static void test_new_reasons_are_recorded(void **arg)
{
	(void)arg;
	begin_recorded(&live_ops, 0);
	run_scans(5);
	pipeline_raise(w.p, FAULT_BIT(GPU_LOST));
	run_scans(7);
	assert_int_equal(pipeline_now(w.p)->state, STATE_DEGRADED);
	triggers_are(0, 0, 1, 0, 0);
	w.run_error = -EIO;
	run_scans(8);
	w.run_error = 0;
	assert_true(pipeline_now(w.p)->fault & FAULT_BIT(MC_ERROR));
	triggers_are(0, 0, 2, 0, 0);
	w.events = BUS_EV_DOWN;
	run_scans(10);
	assert_int_equal(pipeline_now(w.p)->state, STATE_INHIBIT);
	triggers_are(0, 0, 3, 0, 0);
	w.events |= BUS_EV_FOREIGN;
	run_scans(12);
	triggers_are(0, 0, 4, 0, 0);
	w.events = 0;
	run_scans(60);
	assert_int_equal(pipeline_now(w.p)->state, STATE_DEGRADED);
	triggers_are(0, 0, 4, 0, 0); /* what is over is no news */
	w.events = BUS_EV_DOWN;
	run_scans(62);
	triggers_are(0, 0, 5, 0, 0);
	end();
}

/* What is known from the start is no event, what makes it worse is. */
static void test_starting_is_no_event(void **arg)
{
	(void)arg;
	begin(&live_ops, 0, NULL);
	open_recorded(NULL);
	run_scans(3);
	pipeline_raise(w.p, FAULT_BIT(GPU_NONE));
	run_scans(5);
	pipeline_set_mc(w.p, w.mc, PUBLISH_BACKEND_CPU, 16384);
	run_scans(7);
	assert_int_equal(pipeline_now(w.p)->state, STATE_DEGRADED);
	triggers_are(0, 0, 0, 0, 0);
	end();

	begin(&live_ops, 0, NULL);
	open_recorded(NULL);
	run_scans(3);
	assert_int_equal(pipeline_now(w.p)->state, STATE_INIT);
	w.events = BUS_EV_DOWN;
	run_scans(5);
	assert_int_equal(pipeline_now(w.p)->state, STATE_INHIBIT);
	triggers_are(0, 0, 1, 0, 0);
	end();
}

/* ---- ends --------------------------------------------------------------------------------------------------------- */

static void test_end_of_log(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	w.end_ns = SCAN_0 + 10 * SCAN;
	int err = 0;

	while (!err) {
		err = pipeline_step(w.p);
	}
	assert_int_equal(err, -ENODATA);
	assert_int_equal(pipeline_stats(w.p)->evaluations, 11);
	assert_int_equal(w.cycles, 11);
	assert_int_equal(pipeline_step(w.p), -ENODATA);
	end();
}

static void test_bus_error(void **arg)
{
	(void)arg;
	begin(&log_ops, 0, NULL);
	w.recv_error = -EIO;
	assert_int_equal(pipeline_step(w.p), -EIO);
	end();
}

static void test_open_error(void **arg)
{
	struct pipeline *p = NULL;

	(void)arg;
	begin(&log_ops, 0, NULL);
	snprintf(w.cfg.bus_out_interface, sizeof(w.cfg.bus_out_interface), "can9");
	const struct pipeline_open o = {.cfg = &w.cfg, .bus = &w.bus, .mc = w.mc};

	assert_int_equal(pipeline_open(&o, &p), -EINVAL);
	assert_null(p);
	pipeline_close(NULL);
	end();
}

static void test_same_in_same_out(void **arg)
{
	struct bus_frame *first = malloc(OUT_MAX * sizeof(*first));
	int n = 0;

	(void)arg;
	assert_non_null(first);
	for (int round = 0; round < 2; round++) {
		begin(&log_ops, 0, NULL);
		run_scans(30);
		dangerous_scene();
		run_scans(60);
		if (!round) {
			n = w.n_out;
			memcpy(first, w.out, (size_t)n * sizeof(*first));
		}
		end();
	}
	assert_int_equal(w.n_out, n);
	for (int i = 0; i < n; i++) {
		assert_int_equal(first[i].t_ns, w.out[i].t_ns);
		assert_int_equal(first[i].id, w.out[i].id);
		assert_memory_equal(first[i].data, w.out[i].data, 8);
	}
	free(first);
}

static int free_world(void **arg)
{
	(void)arg;
	free(w.out);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_init_frames_come_first),
		cmocka_unit_test(test_request_period_is_exact),
		cmocka_unit_test(test_slower_messages),
		cmocka_unit_test(test_one_evaluation_per_scan),
		cmocka_unit_test(test_silence_ends_a_scan),
		cmocka_unit_test(test_brakes_and_releases),
		cmocka_unit_test(test_futures_begin_without_our_braking),
		cmocka_unit_test(test_no_lead_is_not_no_risk),
		cmocka_unit_test(test_radar_silence_inhibits),
		cmocka_unit_test(test_an_input_goes_stale_between_periods),
		cmocka_unit_test(test_a_second_stale_input_is_no_news),
		cmocka_unit_test(test_input_fault_inhibits),
		cmocka_unit_test(test_invalid_ego_is_no_evaluation),
		cmocka_unit_test(test_refused_frames_inhibit),
		cmocka_unit_test(test_bus_events),
		cmocka_unit_test(test_stall_distrusts_the_queue),
		cmocka_unit_test(test_frames_of_a_stall_are_not_used),
		cmocka_unit_test(test_late_period),
		cmocka_unit_test(test_backend_error_falls_back),
		cmocka_unit_test(test_foreign_result_is_wrong_memory),
		cmocka_unit_test(test_impossible_request_is_an_error),
		cmocka_unit_test(test_cut_batch),
		cmocka_unit_test(test_newest_scan_waits),
		cmocka_unit_test(test_old_result_is_late),
		cmocka_unit_test(test_deadline_cuts_the_batch),
		cmocka_unit_test(test_deaf_worker_is_stuck),
		cmocka_unit_test(test_backend_comes_late),
		cmocka_unit_test(test_backend_is_replaced),
		cmocka_unit_test(test_spare_takes_over_after_an_error),
		cmocka_unit_test(test_impossible_request_keeps_the_backend),
		cmocka_unit_test(test_wrong_bits_twice_are_a_fault),
		cmocka_unit_test(test_spare_takes_over_from_a_stuck_backend),
		cmocka_unit_test(test_arming),
		cmocka_unit_test(test_quiet_sends_nothing),
		cmocka_unit_test(test_new_configuration),
		cmocka_unit_test(test_configuration_that_changes_by_itself),
		cmocka_unit_test(test_last_frames),
		cmocka_unit_test(test_no_clock_no_times),
		cmocka_unit_test(test_clock_stamps_the_edges),
		cmocka_unit_test(test_stage_miss),
		cmocka_unit_test(test_a_drive_is_told),
		cmocka_unit_test(test_confirmed_by_its_echo),
		cmocka_unit_test(test_end_to_end_miss),
		cmocka_unit_test(test_refused_frame_sends_nothing),
		cmocka_unit_test(test_stalled_worker),
		cmocka_unit_test(test_missed_periods_are_told),
		cmocka_unit_test(test_timing_says_which_stage),
		cmocka_unit_test(test_levels_and_marks_are_recorded),
		cmocka_unit_test(test_misses_of_stages_and_periods_are_recorded),
		cmocka_unit_test(test_late_and_skipped_are_recorded),
		cmocka_unit_test(test_new_reasons_are_recorded),
		cmocka_unit_test(test_starting_is_no_event),
		cmocka_unit_test(test_end_of_log),
		cmocka_unit_test(test_bus_error),
		cmocka_unit_test(test_open_error),
		cmocka_unit_test(test_same_in_same_out),
	};

	return cmocka_run_group_tests(tests, NULL, free_world);
}
