/* A library that a program is started with. It notes in DISK_LOG what the program does to the files of DISK_FOLDER, in order. It ends
   the program with SIGKILL where it does so for the time DISK_CUT. `disk.rs` reads the notes and says what is left after a loss of power.

   A change is noted before it is made, a synchronisation after it has succeeded. So whatever the program could know to be on disk is
   noted. SQLite's index of its log is memory that is shared through a file; it is mapped, never synchronised, and not noted. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

/* What is known of a descriptor. */
enum { OTHER, FILE_OF_FOLDER, FOLDER };
static char kinds[1024];
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int notes = -2;
static long done;

struct note {
    uint64_t kind, file, offset, length;
};

#define REAL(name, type, ...) \
    static type (*real)(__VA_ARGS__); \
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, #name)

static int kind_of(int fd) { return fd >= 0 && fd < (int)sizeof kinds ? kinds[fd] : OTHER; }

static const char *name_in_folder(const char *path) {
    const char *folder = getenv("DISK_FOLDER");
    size_t length = folder ? strlen(folder) : 0;
    return length && !strncmp(path, folder, length) && path[length] == '/' ? path + length + 1 : 0;
}

static void note(char kind, int fd, uint64_t offset, const void *bytes, uint64_t length) {
    struct stat of = {0};
    if (fd >= 0) fstat(fd, &of);
    struct note head = {(uint64_t)kind, of.st_ino, offset, length};
    struct iovec parts[] = {{&head, sizeof head}, {(void *)bytes, bytes ? length : 0}};
    REAL(open, int, const char *, int, ...);
    if (notes == -2) notes = real(getenv("DISK_LOG"), O_WRONLY | O_APPEND | O_CREAT, 0600);
    if (writev(notes, parts, 2) < 0) abort();
}

/* One more thing is done. */
static void count(void) {
    const char *cut = getenv("DISK_CUT");
    if (cut && ++done == atol(cut)) kill(getpid(), SIGKILL);
}

static void change(char kind, int fd, uint64_t offset, const void *bytes, uint64_t length) {
    pthread_mutex_lock(&lock);
    note(kind, fd, offset, bytes, length);
    count();
    pthread_mutex_unlock(&lock);
}

static int opened(int fd, const char *path, int existed) {
    const char *name = name_in_folder(path), *folder = getenv("DISK_FOLDER");
    if (fd < 0 || fd >= (int)sizeof kinds) return fd;
    kinds[fd] = name ? FILE_OF_FOLDER : folder && !strcmp(path, folder) ? FOLDER : OTHER;
    if (name && !existed) change('C', fd, 0, name, strlen(name));
    return fd;
}

int open(const char *path, int flags, ...) {
    REAL(open, int, const char *, int, ...);
    va_list more;
    va_start(more, flags);
    mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0;
    va_end(more);
    int existed = !access(path, F_OK);
    return opened(real(path, flags, mode), path, existed);
}

int open64(const char *path, int flags, ...) {
    va_list more;
    va_start(more, flags);
    mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0;
    va_end(more);
    return open(path, flags, mode);
}

int close(int fd) {
    REAL(close, int, int);
    if (fd >= 0 && fd < (int)sizeof kinds) kinds[fd] = OTHER;
    return real(fd);
}

ssize_t write(int fd, const void *bytes, size_t length) {
    REAL(write, ssize_t, int, const void *, size_t);
    if (kind_of(fd) == FILE_OF_FOLDER) change('W', fd, (uint64_t)lseek(fd, 0, SEEK_CUR), bytes, length);
    return real(fd, bytes, length);
}

ssize_t pwrite64(int fd, const void *bytes, size_t length, off64_t offset) {
    REAL(pwrite64, ssize_t, int, const void *, size_t, off64_t);
    if (kind_of(fd) == FILE_OF_FOLDER) change('W', fd, (uint64_t)offset, bytes, length);
    return real(fd, bytes, length, offset);
}

ssize_t pwrite(int fd, const void *bytes, size_t length, off_t offset) { return pwrite64(fd, bytes, length, offset); }

int ftruncate64(int fd, off64_t length) {
    REAL(ftruncate64, int, int, off64_t);
    if (kind_of(fd) == FILE_OF_FOLDER) change('T', fd, 0, 0, (uint64_t)length);
    return real(fd, length);
}

int ftruncate(int fd, off_t length) { return ftruncate64(fd, length); }

static int synchronise(int fd, int (*real)(int)) {
    int kind = kind_of(fd);
    if (kind == OTHER) return real(fd);
    pthread_mutex_lock(&lock);
    count();
    int failed = real(fd);
    if (!failed) note(kind == FOLDER ? 'D' : 'S', fd, 0, 0, 0);
    pthread_mutex_unlock(&lock);
    return failed;
}

int fsync(int fd) {
    REAL(fsync, int, int);
    return synchronise(fd, real);
}

int fdatasync(int fd) {
    REAL(fdatasync, int, int);
    return synchronise(fd, real);
}

int unlink(const char *path) {
    REAL(unlink, int, const char *);
    const char *name = name_in_folder(path);
    if (name && !access(path, F_OK)) change('U', -1, 0, name, strlen(name));
    return real(path);
}

/* What this library does not follow must not be done to these files. */
int rename(const char *from, const char *to) {
    REAL(rename, int, const char *, const char *);
    if (name_in_folder(from) || name_in_folder(to)) abort();
    return real(from, to);
}

ssize_t pwritev(int fd, const struct iovec *parts, int count, off_t offset) {
    REAL(pwritev, ssize_t, int, const struct iovec *, int, off_t);
    if (kind_of(fd) != OTHER) abort();
    return real(fd, parts, count, offset);
}
