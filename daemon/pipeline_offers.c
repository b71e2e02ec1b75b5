/* SPDX-License-Identifier: MIT
 * What other threads hand to the pipeline, taken over between two steps: a backend, a configuration, arming, a mark.
 */
#include "pipeline_priv.h"

static void watch(struct pipeline *p)
{
	const struct bus_ops *ops = p->o.bus->ops;
	int fd = mc_eventfd(p->mc);

	p->watched = fd >= 0 && ops->watch && ops->watch(p->o.bus, fd) == 0;
}

static void take_mc(struct pipeline *p)
{
	struct mc *mc = __atomic_load_n(&p->offered_mc, __ATOMIC_ACQUIRE);

	if (mc && mc != p->mc) {
		p->mc = mc;
		p->running = 0; /* what the other backend was at is abandoned */
		p->in.backend = p->offered_backend;
		p->in.samples = p->stats.samples = p->offered_samples;
		watch(p);
	}
}

void pipeline_take_offers(struct pipeline *p)
{
	take_mc(p);
	p->o.cfg = __atomic_load_n(&p->offered_cfg, __ATOMIC_ACQUIRE);
	p->in.hash = __atomic_load_n(&p->hash, __ATOMIC_ACQUIRE);
	if (p->in.state == STATE_FAULT) {
		pipeline_arm(p, 0);
	}
	p->in.withheld = p->o.needs_arm && !pipeline_armed(p);
	if (__atomic_exchange_n(&p->mark, 0, __ATOMIC_ACQ_REL)) {
		pipeline_event(p, RECORDER_MARK);
	}
}

void pipeline_set_mc(struct pipeline *p, struct mc *mc, enum publish_backend backend,
		     uint32_t samples)
{
	p->offered_backend = backend;
	p->offered_samples = samples;
	__atomic_store_n(&p->offered_mc, mc, __ATOMIC_RELEASE);
}

void pipeline_set_spare(struct pipeline *p, struct mc *spare, uint32_t samples)
{
	p->spare_samples = samples;
	__atomic_store_n(&p->spare, spare, __ATOMIC_RELEASE);
}

static uint16_t hash_of(const struct pipeline *p, const struct config *cfg)
{
	uint64_t h = config_hash(cfg, p->o.map);

	return (uint16_t)(h ^ h >> 16 ^ h >> 32 ^ h >> 48 ^ contract_hash());
}

void pipeline_set_config(struct pipeline *p, const struct config *cfg)
{
	__atomic_store_n(&p->hash, hash_of(p, cfg), __ATOMIC_RELEASE);
	__atomic_store_n(&p->offered_cfg, cfg, __ATOMIC_RELEASE);
}

void pipeline_arm(struct pipeline *p, int on)
{
	__atomic_store_n(&p->arm, on, __ATOMIC_RELEASE);
}

void pipeline_check_config(struct pipeline *p)
{
	if (hash_of(p, p->offered_cfg) != p->hash) {
		pipeline_raise(p, FAULT_BIT(CONFIG));
	}
}

int pipeline_armed(const struct pipeline *p)
{
	return __atomic_load_n(&p->arm, __ATOMIC_ACQUIRE);
}

void pipeline_raise(struct pipeline *p, uint32_t fault)
{
	__atomic_fetch_or(&p->outside, fault, __ATOMIC_ACQ_REL);
}

void pipeline_mark(struct pipeline *p)
{
	__atomic_store_n(&p->mark, 1, __ATOMIC_RELEASE);
}
