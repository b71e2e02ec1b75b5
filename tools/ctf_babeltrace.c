/* SPDX-License-Identifier: MIT
 * Traces through libbabeltrace2: one source for every folder with metadata below the one given, merged by time, and a
 * sink that hands over each event. See ctf.h.
 */
#include "ctf.h"
#include <babeltrace2/babeltrace.h>
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TRACES_MAX 64
#define PATH_LEN   1024

struct reader {
	ctf_event *event;
	void *arg;
	struct ctf_lost *lost;
	int status; /* what ended the reading */
	bt_message_iterator *it;
};

/* ---- one event ------------------------------------------------------------------------------------- */

static void take_field(struct ctf_field *f, const bt_field *value)
{
	const bt_field_class_type t = bt_field_get_class_type(value);

	if (bt_field_class_type_is(t, BT_FIELD_CLASS_TYPE_UNSIGNED_INTEGER)) {
		f->i = (int64_t)bt_field_integer_unsigned_get_value(value);
		f->f = (double)f->i;
	} else if (bt_field_class_type_is(t, BT_FIELD_CLASS_TYPE_SIGNED_INTEGER)) {
		f->i = bt_field_integer_signed_get_value(value);
		f->f = (double)f->i;
	} else if (t == BT_FIELD_CLASS_TYPE_DOUBLE_PRECISION_REAL) {
		f->f = bt_field_real_double_precision_get_value(value);
	} else if (t == BT_FIELD_CLASS_TYPE_STRING) {
		/* an empty one may still show what its buffer held before */
		f->text = bt_field_string_get_length(value) ? bt_field_string_get_value(value) : "";
	}
}

static void take_payload(struct ctf_record *r, const bt_field *payload)
{
	const bt_field_class *c = payload ? bt_field_borrow_class_const(payload) : NULL;
	const uint64_t n = c ? bt_field_class_structure_get_member_count(c) : 0;

	for (uint64_t i = 0; i < n && r->n < CTF_FIELDS_MAX; i++) {
		struct ctf_field *f = &r->field[r->n++];

		*f = (struct ctf_field){
			.name = bt_field_class_structure_member_get_name(
				bt_field_class_structure_borrow_member_by_index_const(c, i))};
		take_field(f, bt_field_structure_borrow_member_field_by_index_const(payload, i));
	}
}

static int64_t pid_of(const bt_event *e)
{
	const bt_field *context = bt_event_borrow_common_context_field_const(e);
	const bt_field *pid =
		context ? bt_field_structure_borrow_member_field_by_name_const(context, "vpid")
			: NULL;
	struct ctf_field f = {0};

	if (pid) {
		take_field(&f, pid);
	}
	return f.i;
}

static int take_event(struct reader *rd, const bt_message *m)
{
	const bt_event *e = bt_message_event_borrow_event_const(m);
	struct ctf_record r = {.name = bt_event_class_get_name(bt_event_borrow_class_const(e))};
	const bt_clock_snapshot *t = bt_message_event_borrow_default_clock_snapshot_const(m);

	if (!r.name || bt_clock_snapshot_get_ns_from_origin(t, &r.t_ns)) {
		return -EBADMSG;
	}
	r.pid = pid_of(e);
	take_payload(&r, bt_event_borrow_payload_field_const(e));
	return rd->event(rd->arg, &r);
}

static int take_message(struct reader *rd, const bt_message *m)
{
	uint64_t n = 0;

	switch (bt_message_get_type(m)) {
	case BT_MESSAGE_TYPE_EVENT:
		return take_event(rd, m);
	case BT_MESSAGE_TYPE_DISCARDED_EVENTS:
		if (bt_message_discarded_events_get_count(m, &n) ==
		    BT_PROPERTY_AVAILABILITY_AVAILABLE) {
			rd->lost->events += n;
		}
		return 0;
	case BT_MESSAGE_TYPE_DISCARDED_PACKETS:
		if (bt_message_discarded_packets_get_count(m, &n) ==
		    BT_PROPERTY_AVAILABILITY_AVAILABLE) {
			rd->lost->packets += n;
		}
		return 0;
	default:
		return 0;
	}
}

/* ---- sink ------------------------------------------------------------------------------------------ */

static bt_graph_simple_sink_component_initialize_func_status begin(bt_message_iterator *it,
								   void *data)
{
	((struct reader *)data)->it = it;
	return BT_GRAPH_SIMPLE_SINK_COMPONENT_INITIALIZE_FUNC_STATUS_OK;
}

static bt_graph_simple_sink_component_consume_func_status consume(bt_message_iterator *it,
								  void *data)
{
	struct reader *rd = data;
	bt_message_array_const m;
	uint64_t n;

	switch (bt_message_iterator_next(it, &m, &n)) {
	case BT_MESSAGE_ITERATOR_NEXT_STATUS_OK:
		break;
	case BT_MESSAGE_ITERATOR_NEXT_STATUS_END:
		return BT_GRAPH_SIMPLE_SINK_COMPONENT_CONSUME_FUNC_STATUS_END;
	case BT_MESSAGE_ITERATOR_NEXT_STATUS_AGAIN:
		return BT_GRAPH_SIMPLE_SINK_COMPONENT_CONSUME_FUNC_STATUS_AGAIN;
	default:
		rd->status = -EBADMSG;
		return BT_GRAPH_SIMPLE_SINK_COMPONENT_CONSUME_FUNC_STATUS_ERROR;
	}
	for (uint64_t i = 0; i < n; i++) {
		rd->status = rd->status ? rd->status : take_message(rd, m[i]);
		bt_message_put_ref(m[i]);
	}
	return rd->status ? BT_GRAPH_SIMPLE_SINK_COMPONENT_CONSUME_FUNC_STATUS_END
			  : BT_GRAPH_SIMPLE_SINK_COMPONENT_CONSUME_FUNC_STATUS_OK;
}

/* ---- graph ----------------------------------------------------------------------------------------- */

struct graph {
	bt_graph *graph;
	const bt_plugin *ctf, *utils;
	const bt_component_filter *mux;
	uint64_t mux_in;
	const bt_component_sink *sink;
};

static int add_mux(struct graph *g, struct reader *rd)
{
	const bt_component_class_filter *c =
		bt_plugin_borrow_filter_component_class_by_name_const(g->utils, "muxer");

	return !c ||
			       bt_graph_add_filter_component(g->graph, c, "merge", NULL,
							     BT_LOGGING_LEVEL_NONE, &g->mux) ||
			       bt_graph_add_simple_sink_component(g->graph, "events", begin,
								  consume, NULL, rd, &g->sink)
		       ? -ENOTSUP
		       : 0;
}

static int add_source(struct graph *g, const char *dir, int i)
{
	const bt_component_class_source *c =
		bt_plugin_borrow_source_component_class_by_name_const(g->ctf, "fs");
	bt_value *params = bt_value_map_create(), *inputs = NULL;
	const bt_component_source *src = NULL;
	char name[sizeof("trace") + 11];
	int bad;

	snprintf(name, sizeof(name), "trace%d", i);
	bad = !c || !params || bt_value_map_insert_empty_array_entry(params, "inputs", &inputs) ||
	      bt_value_array_append_string_element(inputs, dir) ||
	      bt_graph_add_source_component(g->graph, c, name, params, BT_LOGGING_LEVEL_NONE, &src);
	bt_value_put_ref(params);
	for (uint64_t k = 0; !bad && k < bt_component_source_get_output_port_count(src); k++) {
		bad = bt_graph_connect_ports(
			      g->graph,
			      bt_component_source_borrow_output_port_by_index_const(src, k),
			      bt_component_filter_borrow_input_port_by_index_const(g->mux,
										   g->mux_in++),
			      NULL) != BT_GRAPH_CONNECT_PORTS_STATUS_OK;
	}
	return bad ? -EBADMSG : 0;
}

static int run(struct graph *g, struct reader *rd)
{
	bt_graph_run_status s;

	if (bt_graph_connect_ports(
		    g->graph, bt_component_filter_borrow_output_port_by_index_const(g->mux, 0),
		    bt_component_sink_borrow_input_port_by_index_const(g->sink, 0), NULL)) {
		return -EBADMSG;
	}
	do {
		s = bt_graph_run(g->graph);
	} while (s == BT_GRAPH_RUN_STATUS_AGAIN);
	return rd->status ? rd->status : s == BT_GRAPH_RUN_STATUS_OK ? 0 : -EBADMSG;
}

/* ---- folders --------------------------------------------------------------------------------------- */

struct found {
	int n;
	char dir[TRACES_MAX][PATH_LEN];
};

/* Snapshots of one session lie side by side. */
static void look(struct found *f, const char *dir)
{
	char path[PATH_LEN];
	struct dirent **e = NULL;
	const int n = scandir(dir, &e, NULL, alphasort);

	for (int i = 0; i < n; i++) {
		const int is_dir = e[i]->d_type == DT_DIR && e[i]->d_name[0] != '.';

		if (!strcmp(e[i]->d_name, "metadata") && f->n < TRACES_MAX) {
			snprintf(f->dir[f->n++], PATH_LEN, "%s", dir);
		} else if (is_dir && snprintf(path, sizeof(path), "%s/%s", dir, e[i]->d_name) <
					     (int)sizeof(path)) {
			look(f, path);
		}
		free(e[i]);
	}
	free(e);
}

/* ---- metadata --------------------------------------------------------------------------------------- */

/* The head of a packet of metadata, CTF 1.8.3, Sec. 7.1, in words of this machine. */
enum { HEAD_MAGIC = 0, HEAD_CONTENT = 6, HEAD_PACKET = 7, HEAD_WORDS = 9 }; /* sizes in bits */
#define PACKET_MAGIC 0x75d11d57u
#define HEAD_BITS    (37 * 8u)

static int is_whole(const uint32_t head[HEAD_WORDS], long bytes)
{
	return head[HEAD_MAGIC] == PACKET_MAGIC && head[HEAD_CONTENT] >= HEAD_BITS &&
	       head[HEAD_CONTENT] <= head[HEAD_PACKET] && head[HEAD_PACKET] % 8 == 0 &&
	       head[HEAD_PACKET] / 8 <= bytes;
}

/* Cut within a packet it would be read for ever; what has no packets libbabeltrace2 judges by itself. 0 or -EPROTO. */
static int check_metadata(const char *dir)
{
	char path[PATH_LEN + sizeof("/metadata")];
	uint32_t head[HEAD_WORDS] = {0};
	long at = 0, size;

	snprintf(path, sizeof(path), "%s/metadata", dir);
	FILE *f = fopen(path, "r");

	if (!f) {
		return 0;
	}
	size = fseek(f, 0, SEEK_END) ? 0 : ftell(f);
	while (at < size) {
		memset(head, 0, sizeof(head));
		fseek(f, at, SEEK_SET);
		if (fread(head, 1, sizeof(head), f) == 0 || !is_whole(head, size - at)) {
			break;
		}
		at += head[HEAD_PACKET] / 8;
	}
	fclose(f);
	return at < size && (at || head[HEAD_MAGIC] == PACKET_MAGIC) ? -EPROTO : 0;
}

static int load(struct graph *g)
{
	return bt_plugin_find("ctf", BT_TRUE, BT_TRUE, BT_TRUE, BT_TRUE, BT_TRUE, &g->ctf) ||
			       bt_plugin_find("utils", BT_TRUE, BT_TRUE, BT_TRUE, BT_TRUE, BT_TRUE,
					      &g->utils)
		       ? -ENOTSUP
		       : 0;
}

static const char *why_not(int status)
{
	switch (status) {
	case -ENOENT:
		return "no trace in this folder (no file named metadata)";
	case -ENOTSUP:
		return "libbabeltrace2 lacks its plugins ctf and utils";
	case -ENOMEM:
		return "out of memory";
	case -EPROTO:
		return "its file metadata is cut off or damaged: copy the trace again, after aebmc "
		       "trace stop";
	default:
		return "not a readable trace: cut off, damaged, or its session not stopped (aebmc "
		       "trace stop)";
	}
}

int ctf_read(const char *dir, ctf_event *event, void *arg, struct ctf_lost *lost, char *err,
	     int err_len)
{
	struct reader rd = {.event = event, .arg = arg, .lost = lost};
	struct found *f = calloc(1, sizeof(*f));
	struct graph g = {.graph = bt_graph_create(0)};
	int status = f && g.graph ? 0 : -ENOMEM;

	*lost = (struct ctf_lost){0};
	if (!status) {
		look(f, dir);
		status = f->n ? load(&g) : -ENOENT;
	}
	status = status ? status : add_mux(&g, &rd);
	for (int i = 0; !status && i < f->n; i++) {
		dir = f->dir[i];
		status = check_metadata(dir);
		status = status ? status : add_source(&g, dir, i);
	}
	status = status ? status : run(&g, &rd);
	if (status) {
		snprintf(err, (size_t)err_len, "%s: %s", dir, why_not(status));
		bt_current_thread_clear_error();
	}
	bt_graph_put_ref(g.graph);
	bt_plugin_put_ref(g.ctf);
	bt_plugin_put_ref(g.utils);
	free(f);
	return status;
}
