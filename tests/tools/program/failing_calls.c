/* Calls of the system that fail once: preloaded into a program and all processes it starts, which share one counter.

Counted are calls that write below the folder FAILING_ROOT (write, create, resize, rename, flush to the disk), and
forks. The call with the number `target` fails; with `lasting`, all later ones of its kind do, as on a full disk. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#define LOGGED 65536

struct state {
    int enabled, target, lasting, full; /* full: kind whose calls go on failing, 0 for none */
    int write_error;                    /* errno of writes that fail */
    int count;
    char kinds[LOGGED];
};

static struct state *state;
static const char *root;

__attribute__((constructor)) static void begin(void) {
    const char *name = getenv("FAILING_STATE");
    root = getenv("FAILING_ROOT");
    int (*real_open)(const char *, int, ...) = dlsym(RTLD_NEXT, "open");
    int file = name && root ? real_open(name, O_RDWR) : -1;
    if (file < 0) return;
    void *shared = mmap(NULL, sizeof(struct state), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (shared != MAP_FAILED) state = shared;
}

static int below(const char *path) {
    char whole[PATH_MAX], real[PATH_MAX];
    if (!path) return 0;
    if (path[0] != '/') {
        if (!getcwd(real, sizeof real)) return 0;
        if (snprintf(whole, sizeof whole, "%s/%s", real, path) >= (int)sizeof whole) return 0;
        path = whole;
    }
    return !strncmp(path, root, strlen(root));
}

static int file_below(int file) {
    char link[64], path[PATH_MAX];
    struct stat about;
    if (fstat(file, &about) || !S_ISREG(about.st_mode)) return 0;
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t size = readlink(link, path, sizeof path - 1);
    if (size < 0) return 0;
    path[size] = 0;
    return below(path);
}

/* 1 where this call fails, with errno set. */
static int fails(char kind, int error) {
    int number = __sync_add_and_fetch(&state->count, 1);
    if (number < LOGGED) state->kinds[number] = kind;
    int now = number == state->target;
    if (now && state->lasting) state->full = kind;
    if (!now && state->full != kind) return 0;
    errno = error;
    return 1;
}

#define ACTIVE (state && state->enabled)
#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int file, const void *from, size_t size) {
    if (ACTIVE && file_below(file) && fails('w', state->write_error)) return -1;
    return REAL(write)(file, from, size);
}
ssize_t pwrite(int file, const void *from, size_t size, off_t at) {
    if (ACTIVE && file_below(file) && fails('w', state->write_error)) return -1;
    return REAL(pwrite)(file, from, size, at);
}
ssize_t pwrite64(int file, const void *from, size_t size, off64_t at) {
    if (ACTIVE && file_below(file) && fails('w', state->write_error)) return -1;
    return REAL(pwrite64)(file, from, size, at);
}
ssize_t writev(int file, const struct iovec *from, int count) {
    if (ACTIVE && file_below(file) && fails('w', state->write_error)) return -1;
    return REAL(writev)(file, from, count);
}
ssize_t sendfile(int to, int from, off_t *at, size_t size) {
    if (ACTIVE && file_below(to) && fails('w', state->write_error)) return -1;
    return REAL(sendfile)(to, from, at, size);
}
ssize_t copy_file_range(int from, off64_t *at, int to, off64_t *there, size_t size, unsigned flags) {
    if (ACTIVE && file_below(to) && fails('w', state->write_error)) return -1;
    return REAL(copy_file_range)(from, at, to, there, size, flags);
}
int fsync(int file) {
    if (ACTIVE && fails('s', EIO)) return -1;
    return REAL(fsync)(file);
}
int fdatasync(int file) {
    if (ACTIVE && fails('s', EIO)) return -1;
    return REAL(fdatasync)(file);
}
int ftruncate(int file, off_t size) {
    if (ACTIVE && file_below(file) && fails('t', EIO)) return -1;
    return REAL(ftruncate)(file, size);
}
int ftruncate64(int file, off64_t size) {
    if (ACTIVE && file_below(file) && fails('t', EIO)) return -1;
    return REAL(ftruncate64)(file, size);
}
int rename(const char *from, const char *to) {
    if (ACTIVE && below(to) && fails('r', EIO)) return -1;
    return REAL(rename)(from, to);
}
int renameat(int at, const char *from, int there, const char *to) {
    if (ACTIVE && fails('r', EIO)) return -1;
    return REAL(renameat)(at, from, there, to);
}
int mkdir(const char *path, mode_t mode) {
    if (ACTIVE && below(path) && fails('c', ENOSPC)) return -1;
    return REAL(mkdir)(path, mode);
}
pid_t fork(void) {
    if (ACTIVE && fails('f', EAGAIN)) return -1;
    return REAL(fork)();
}

#define OPEN(name)                                                                          \
    int name(const char *path, int flags, ...) {                                            \
        va_list more;                                                                       \
        va_start(more, flags);                                                              \
        mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0;             \
        va_end(more);                                                                       \
        if (ACTIVE && (flags & O_CREAT) && below(path) && fails('c', ENOSPC)) return -1;    \
        return REAL(name)(path, flags, mode);                                               \
    }
OPEN(open)
OPEN(open64)
