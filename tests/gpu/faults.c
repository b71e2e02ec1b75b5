/* SPDX-License-Identifier: MIT
 * A kernel that stores out of bounds and a kernel that hangs, each in a process of its own: the backend says what
 * happened, the CPU backend beside it goes on, and after a hang that ends the next batch is right again.
 */
#include "mc_cuda_host.h"
#include "tap.h"
#include "scenes.h"
#include <errno.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#define N 16384u

extern const void *const cuda_fault_stray, *const cuda_fault_hang;

struct pair {
	struct mc_backend *cpu, *gpu;
	struct mc_request req;
	struct mc_result right;
};

static int open_pair(struct pair *p)
{
	const struct mc_params params = {
		.kind = MC_SOBOL, .seed = 1, .n_resident = N, .threads = 1};

	p->req = scene_moving(N);
	return mc_cpu_ops.open(&params, &p->cpu) || mc_cuda_ops.open(&params, &p->gpu) ||
	       mc_cpu_ops.run(p->cpu, &p->req, NULL, &p->right);
}

static int launch(const struct pair *p, const void *kernel, uint32_t *argument)
{
	void *args[] = {&argument};

	return cudaLaunchKernel(kernel, (dim3){1, 1, 1}, (dim3){1, 1, 1}, args, 0, p->gpu->stream);
}

static int run(const struct mc_ops *ops, struct mc_backend *b, const struct pair *p)
{
	struct mc_result res;

	memset(&res, 0, sizeof(res));
	const int err = ops->run(b, &p->req, NULL, &res);

	return err ? err : memcmp(&res, &p->right, sizeof(res)) ? -EBADMSG : 0;
}

static int stray(void)
{
	struct pair p;

	if (!tap_ok(!open_pair(&p), "stray store: both backends open")) {
		return 1;
	}
	tap_ok(run(&mc_cuda_ops, p.gpu, &p) == 0, "stray store: a batch before it");
	tap_ok(launch(&p, cuda_fault_stray, NULL) == 0, "stray store: launched");
	const int err = run(&mc_cuda_ops, p.gpu, &p);

	tap_ok(err == -EFAULT, "stray store: the batch ends with %d, -EFAULT is %d", err, -EFAULT);
	tap_ok(run(&mc_cuda_ops, p.gpu, &p) == -EFAULT, "stray store: so does every later one");
	tap_ok(run(&mc_cpu_ops, p.cpu, &p) == 0, "stray store: the CPU backend goes on");
	mc_cuda_ops.close(p.gpu);
	mc_cpu_ops.close(p.cpu);
	return 0;
}

static int hang(void)
{
	uint32_t *flag = NULL;
	struct pair p;

	if (!tap_ok(!open_pair(&p) &&
			    !cudaHostAlloc((void **)&flag, sizeof(*flag), cudaHostAllocMapped),
		    "hang: both backends open")) {
		return 1;
	}
	*flag = 0;
	p.gpu->sleeps = 5000;
	tap_ok(launch(&p, cuda_fault_hang, flag) == 0, "hang: launched");
	int err = run(&mc_cuda_ops, p.gpu, &p);

	tap_ok(err == -ETIMEDOUT, "hang: the batch ends with %d, -ETIMEDOUT is %d", err,
	       -ETIMEDOUT);
	tap_ok(run(&mc_cuda_ops, p.gpu, &p) == -ETIMEDOUT,
	       "hang: nothing more is launched meanwhile");
	tap_ok(run(&mc_cpu_ops, p.cpu, &p) == 0, "hang: the CPU backend goes on");
	*(volatile uint32_t *)flag = 1;
	for (int i = 0; i < 500 && p.gpu->out->seq != p.gpu->pending; i++) {
		poll(NULL, 0, 10);
	}
	p.req = scene_moving(
		N -
		1); /* another request: the late answer to the first must not pass for its own */
	tap_ok(mc_cpu_ops.run(p.cpu, &p.req, NULL, &p.right) == 0 &&
		       run(&mc_cuda_ops, p.gpu, &p) == 0,
	       "hang: when it is over the late answer is dropped and the next batch is right");
	mc_cuda_ops.close(p.gpu);
	mc_cpu_ops.close(p.cpu);
	return 0;
}

/* While the device hangs the caller's thread is never held up, and closing does not wait for it. */
static int mailbox(void)
{
	const struct mc_params params = {
		.kind = MC_SOBOL, .seed = 1, .n_resident = N, .threads = 1};
	uint32_t *flag = NULL;
	struct pair p;
	struct mc *mc;
	struct mc_result res;
	int got = 0;

	if (!tap_ok(!open_pair(&p) && !mc_open(&mc_cuda_ops, &params, MC_WORKER, &mc) &&
			    !cudaHostAlloc((void **)&flag, sizeof(*flag), cudaHostAllocMapped),
		    "mailbox: open")) {
		return 1;
	}
	*flag = 0;
	/* fills the device: the batch of the other handle has to wait for a block to end */
	int threads = 0;
	void *args[] = {&flag};
	int err = cudaDeviceGetAttribute(&threads, cudaDevAttrMaxThreadsPerMultiProcessor, 0);

	err = err ? err
		  : (int)cudaLaunchKernel(
			    cuda_fault_hang,
			    (dim3){(unsigned int)(p.gpu->info.sms * threads / 512), 1, 1},
			    (dim3){512, 1, 1}, args, 0, p.gpu->stream);
	tap_ok(!err && mc_submit(mc, &p.req) == 0, "mailbox: submitted behind a hang");
	for (int i = 0; i < 200 && !got; i++) {
		poll(NULL, 0, 1);
		got = mc_poll(mc, &res);
	}
	tap_ok(got == 0 && mc_busy(mc), "mailbox: no result, the caller is not held up");
	mc_close(mc);
	tap_ok(1, "mailbox: closed while the worker waits");
	*(volatile uint32_t *)flag = 1;
	return 0;
}

static void in_child(int (*f)(void))
{
	int status = 0;

	tap_state();
	fflush(stdout);
	const pid_t pid = fork();

	if (pid == 0) {
		_exit(f() || fflush(stdout) ? 1 : 0);
	}
	waitpid(pid, &status, 0);
	tap_ok(WIFEXITED(status) && WEXITSTATUS(status) == 0,
	       "its process ended by itself, with 0");
}

int main(void)
{
	in_child(stray);
	in_child(hang);
	in_child(mailbox);
	return tap_end();
}
