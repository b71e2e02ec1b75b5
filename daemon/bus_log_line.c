/* SPDX-License-Identifier: MIT
 * One line of a candump log (candump -L) to a frame and back. Pure; knows no file and no clock.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include "bus.h"
#include "clock.h"

#define LOG_TIME_MAX_S 4000000000LL /* year 2096; leaves room for sums of times in 63 bits */
#define LOG_ID_ERR     0x20000000u  /* CAN_ERR_FLAG as candump prints it */

static int hex_digit(char c)
{
	if (c >= '0' && c <= '9') {
		return c - '0';
	}
	c |= 0x20;
	return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

static int is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r';
}

static const char *skip_blanks(const char *p)
{
	while (is_blank(*p)) {
		p++;
	}
	return p;
}

/* Decimal digits, at most ten, so that the value cannot overflow. Returns how many. */
static int parse_digits(const char **p, int64_t *value)
{
	int n = 0;

	*value = 0;
	for (; **p >= '0' && **p <= '9' && n < 11; n++, (*p)++) {
		*value = *value * 10 + (**p - '0');
	}
	return n <= 10 ? n : 0;
}

/* "(seconds.fraction)" with 6 or 9 decimals. The parsers below return where they stopped, or NULL. */
static const char *parse_time(const char *p, int64_t *t_ns)
{
	int64_t s, frac;
	int n;

	if (*p++ != '(' || !parse_digits(&p, &s) || s > LOG_TIME_MAX_S || *p++ != '.') {
		return NULL;
	}
	n = parse_digits(&p, &frac);
	if ((n != 6 && n != 9) || *p++ != ')') {
		return NULL;
	}
	*t_ns = s * CLOCK_NS_PER_S + frac * (n == 6 ? 1000 : 1);
	return p;
}

static const char *parse_iface(const char *p, char iface[BUS_NAME_MAX])
{
	int n = 0;

	p = skip_blanks(p);
	for (; *p && !is_blank(*p); p++) {
		if (n == BUS_NAME_MAX - 1) {
			return NULL;
		}
		iface[n++] = *p;
	}
	iface[n] = '\0';
	return n > 0 ? skip_blanks(p) : NULL;
}

/* Three digits: standard; eight: extended or an error frame. */
static const char *parse_id(const char *p, struct bus_frame *f)
{
	uint32_t id = 0;
	int n = 0;

	for (; n < 9 && hex_digit(*p) >= 0; n++, p++) {
		id = id << 4 | (uint32_t)hex_digit(*p);
	}
	if (*p++ != '#' || (n == 3 && id > 0x7FF) || (n != 3 && n != 8)) {
		return NULL;
	}
	if (id & ~(LOG_ID_ERR | BUS_ID_MASK)) {
		return NULL;
	}
	f->id = n == 3 ? id : (id & BUS_ID_MASK) | BUS_ID_EFF;
	if (id & LOG_ID_ERR) {
		f->id = id & BUS_ID_MASK;
		f->flags |= BUS_ERR;
	}
	return p;
}

static const char *parse_data(const char *p, int max, struct bus_frame *f)
{
	for (f->len = 0; hex_digit(p[0]) >= 0; p += 2) {
		if (f->len == max || hex_digit(p[1]) < 0) {
			return NULL;
		}
		f->data[f->len++] = (uint8_t)(hex_digit(p[0]) << 4 | hex_digit(p[1]));
	}
	return p;
}

static int is_fd_length(int len)
{
	return len <= 8 || (len <= 24 && len % 4 == 0) || len == 32 || len == 48 || len == 64;
}

/* Data, "R" with an optional length, or "#" flags data. */
static const char *parse_payload(const char *p, struct bus_frame *f)
{
	if (*p == 'R') {
		f->flags |= BUS_RTR;
		p++;
		if (*p >= '0' && *p <= '8') {
			f->len = (uint8_t)(*p++ - '0');
		}
		return p;
	}
	if (*p != '#') {
		return parse_data(p, 8, f);
	}
	int flags = hex_digit(p[1]);

	if (flags < 0) {
		return NULL;
	}
	f->flags |= BUS_FD | (flags & 1 ? BUS_BRS : 0) | (flags & 2 ? BUS_ESI : 0);
	p = parse_data(p + 2, BUS_DATA_MAX, f);
	return p && is_fd_length(f->len) ? p : NULL;
}

/* Nothing, or the direction that candump -x adds. */
static const char *parse_suffix(const char *p, struct bus_frame *f)
{
	const char *q = skip_blanks(p);

	if (q > p && (*q == 'R' || *q == 'T')) {
		f->flags |= *q == 'T' ? BUS_LOCAL : 0;
		q = skip_blanks(q + 1);
	}
	return *q == '\0' ? q : NULL;
}

int bus_log_parse(const char *line, char iface[BUS_NAME_MAX], struct bus_frame *f)
{
	const char *p = skip_blanks(line);

	if (*p == '\0' || *p == '#') {
		return -ENOMSG;
	}
	memset(f, 0, sizeof(*f));
	p = parse_time(p, &f->t_ns);
	p = p ? parse_iface(p, iface) : NULL;
	p = p ? parse_id(p, f) : NULL;
	p = p ? parse_payload(p, f) : NULL;
	p = p ? parse_suffix(p, f) : NULL;
	return p ? 0 : -EBADMSG;
}

static int format_payload(const struct bus_frame *f, char *line, int size)
{
	int n = 0;

	if (f->flags & BUS_RTR) {
		return snprintf(line, (size_t)size, f->len ? "R%d" : "R", f->len);
	}
	if (f->flags & BUS_FD) {
		int flags = (f->flags & BUS_BRS ? 1 : 0) | (f->flags & BUS_ESI ? 2 : 0);

		n = snprintf(line, (size_t)size, "#%X", flags);
	}
	for (int i = 0; i < f->len; i++) {
		n += snprintf(line + n, (size_t)(size - n), "%02X", f->data[i]);
	}
	return n;
}

int bus_log_format(const struct bus_frame *f, const char *iface, char *line, int size)
{
	int wide = f->id & BUS_ID_EFF || f->flags & BUS_ERR;
	uint32_t id = (f->id & BUS_ID_MASK) | (f->flags & BUS_ERR ? LOG_ID_ERR : 0);
	int n = snprintf(line, (size_t)size, "(%010lld.%06lld) %s %0*X#",
			 (long long)(f->t_ns / CLOCK_NS_PER_S),
			 (long long)(f->t_ns % CLOCK_NS_PER_S / 1000), iface, wide ? 8 : 3, id);

	return n + format_payload(f, line + n, size - n);
}
