/* SPDX-License-Identifier: MIT
 * Our frames in plain words. Layout, units and names of values come from the contract; here are only the words.
 */
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include "codec.h"
#include "publish_priv.h"

const char *const publish_backend_name[PUBLISH_BACKENDS] = {
	[PUBLISH_BACKEND_NONE] = "none",
	[PUBLISH_BACKEND_CPU] = "cpu",
	[PUBLISH_BACKEND_GPU] = "cuda",
};

enum style { PLAIN, PERCENT, BOUND, REASONS, HEX };

/* In the order of reading. */
static const struct word_row {
	enum publish_msg msg;
	enum contract_signal signal;
	const char *words;
	enum style style;
} word_table[] = {
	{PUBLISH_REQUEST, AEB_REQUEST_STATE, "state", PLAIN},
	{PUBLISH_REQUEST, AEB_REQUEST_STAGE, "stage", PLAIN},
	{PUBLISH_REQUEST, AEB_REQUEST_REQUEST, "request", PLAIN},
	{PUBLISH_REQUEST, AEB_REQUEST_DECEL, "acceleration", PLAIN},
	{PUBLISH_REQUEST, AEB_REQUEST_P_COLLISION, "risk if braking waits", BOUND},
	{PUBLISH_REQUEST, AEB_REQUEST_TTL, "valid for", PLAIN},
	{PUBLISH_REQUEST, AEB_REQUEST_EVAL_ID, "evaluation", PLAIN},
	{PUBLISH_RISK, AEB_RISK_CAUSE, "cause", PLAIN},
	{PUBLISH_RISK, AEB_RISK_P_LOW, "risk if braking waits at least", PERCENT},
	{PUBLISH_RISK, AEB_RISK_P_HIGH, "at most", PERCENT},
	{PUBLISH_RISK, AEB_RISK_IMPACT_SPEED, "impact speed", PLAIN},
	{PUBLISH_RISK, AEB_RISK_EVAL_ID, "evaluation", PLAIN},
	{PUBLISH_MARGIN, AEB_MARGIN_P_DRIVER, "risk if the driver brakes at most", PERCENT},
	{PUBLISH_MARGIN, AEB_MARGIN_P_NOBODY, "if nobody does at most", PERCENT},
	{PUBLISH_MARGIN, AEB_MARGIN_SAFE_HEADWAY, "headway for 5 % risk", PLAIN},
	{PUBLISH_MARGIN, AEB_MARGIN_TTC, "time to collision", PLAIN},
	{PUBLISH_MARGIN, AEB_MARGIN_EVAL_ID, "evaluation", PLAIN},
	{PUBLISH_STATUS, AEB_STATUS_STATE, "state", PLAIN},
	{PUBLISH_STATUS, AEB_STATUS_REASONS, "reasons", REASONS},
	{PUBLISH_STATUS, AEB_STATUS_BACKEND, "backend", PLAIN},
	{PUBLISH_STATUS, AEB_STATUS_TRANSMIT, "transmit", PLAIN},
	{PUBLISH_STATUS, AEB_STATUS_HASH, "hash", HEX},
	{PUBLISH_TIMING, AEB_TIMING_INPUT_AGE, "input age", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_MC_TIME, "batch", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_DECISION_TIME, "decision", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_TOTAL_TIME, "total", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_EVAL_ID, "evaluation", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_STAGE_MISSES, "stage misses", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_LATE_RESULTS, "late results", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_PERIOD_MISSES, "period misses", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_SKIPPED_SCANS, "skipped scans", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_SAMPLES, "samples", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_HASH, "hash", HEX},
	{PUBLISH_TIMING, AEB_TIMING_INPUT_MISSES, "input over budget", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_MC_MISSES, "batch over budget", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_DECISION_MISSES, "decision over budget", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_TOTAL_MISSES, "total over budget", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_INPUT_P99, "99 % of input", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_MC_P99, "99 % of batch", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_DECISION_P99, "99 % of decision", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_TOTAL_P99, "99 % of total", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_INPUT_MAX, "longest input", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_MC_MAX, "longest batch", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_DECISION_MAX, "longest decision", PLAIN},
	{PUBLISH_TIMING, AEB_TIMING_TOTAL_MAX, "longest total", PLAIN},
};

/* A line under construction; what does not fit is cut off. */
struct line {
	char *text;
	int size, len;
};

static __attribute__((format(printf, 2, 3))) void add(struct line *l, const char *format, ...)
{
	va_list ap;

	va_start(ap, format);
	if (l->len < l->size) {
		l->len += vsnprintf(l->text + l->len, (size_t)(l->size - l->len), format, ap);
	}
	va_end(ap);
}

static void add_reasons(struct line *l, uint64_t bits)
{
	for (int i = 0; i < FAULTS; i++) {
		if (bits >> i & 1) {
			add(l, " %s", fault_table[i].name);
		}
	}
	if (bits >> FAULTS) {
		add(l, " unknown");
	}
	add(l, "%s", bits ? "" : " none");
}

static void add_value(struct line *l, const struct word_row *row, const uint8_t *data)
{
	const struct dbc_signal *sig = &contract_signal[row->signal];
	uint64_t raw = codec_raw(sig, data);
	const char *text = dbc_value_text(sig, raw);
	double value = codec_phys(sig, raw);
	int bound =
		row->style == BOUND && codec_raw(&contract_signal[AEB_REQUEST_P_IS_BOUND], data);

	if (row->style == REASONS) {
		add_reasons(l, raw);
	} else if (row->style == HEX) {
		add(l, " %04llx", (unsigned long long)raw);
	} else if (text) {
		add(l, " %s", text);
	} else if (row->style == PERCENT || row->style == BOUND) {
		add(l, "%s %.4g %%", bound ? " below" : "", 100 * value);
	} else {
		add(l, " %.10g%s%s", value, *sig->unit ? " " : "", sig->unit);
	}
}

int publish_words(const struct publish *p, const struct bus_frame *f, char *line, int size)
{
	struct line l = {.text = line, .size = size};
	uint32_t which = f->id - p->first_id;
	struct e2e_state none = {0};
	enum e2e_status status;

	if (which >= PUBLISH_MSGS || f->flags & (BUS_RTR | BUS_ERR)) {
		return -ENOMSG;
	}
	const struct dbc_message *msg = &contract_message[which];
	const struct e2e_config check = {.kind = E2E_P2, .msg = msg};

	status = e2e_check(&check, &none, f->data, f->len);
	add(&l, "%s", msg->name);
	if (status == E2E_WRONG_CRC || status == E2E_WRONG_LENGTH) {
		add(&l, ": not usable, %s", e2e_status_name[status]);
		return -EBADMSG;
	}
	for (size_t i = 0, n = 0; i < sizeof(word_table) / sizeof(word_table[0]); i++) {
		const struct word_row *row = &word_table[i];

		if (row->msg == which &&
		    codec_present(msg, &contract_signal[row->signal], f->data)) {
			add(&l, "%s%s", n++ ? ", " : ": ", row->words);
			add_value(&l, row, f->data);
		}
	}
	return 0;
}
