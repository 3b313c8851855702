"""A library that is loaded before floe's: it notes how files get to the disk, and ends or
interrupts the run at a given call, lets it crash as if inside the allocator, or lets the closing of
a file fail, as on a full network disk.

Calls that count are those that make, rename or remove a checkpoint or bring something to the disk.
"""
import subprocess

from launch import ENVIRONMENT

SOURCE = r"""#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int number(const char* name) {
  const char* text = getenv(name);
  return text != NULL ? atoi(text) : 0;
}

/* Before the call, so that it is the first that does not happen. */
static void note(const char* what, const char* path, const char* second) {
  static int count = 0;
  const char* log = getenv("TEST_LOG");
  if (log != NULL) {
    FILE* file = fopen(log, "a");
    fprintf(file, "%s\t%s\t%s\n", what, path, second);
    fclose(file);
  }
  if (strstr(path, "checkpoint") == NULL && strcmp(what, "fsync") != 0) return;
  if (++count == number("TEST_KILL_AT")) kill(getpid(), SIGKILL);
}

static void name_of(int file, char* path, int size) {
  char link[64];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, path, size - 1);
  path[length > 0 ? length : 0] = 0;
}

/* Whether the file is the one whose closing is to fail. */
static int fails_to_close(int file) {
  char path[4096];
  const char* wanted = getenv("TEST_NO_CLOSE");
  if (wanted == NULL) return 0;
  name_of(file, path, sizeof path);
  return strstr(path, wanted) != NULL;
}

#define REAL(name) ((__typeof__(name)*)dlsym(RTLD_NEXT, #name))

/* As after a crash inside the allocator, which holds its lock. */
static volatile int allocator_is_locked = 0;
extern void* __libc_malloc(size_t size);
extern void __libc_free(void* bytes);
void* malloc(size_t size) {
  while (allocator_is_locked) pause();
  return __libc_malloc(size);
}
void free(void* bytes) {
  while (allocator_is_locked) pause();
  __libc_free(bytes);
}

int rename(const char* a, const char* b) {
  note("rename", a, b);
  return REAL(rename)(a, b);
}
int renameat2(int from, const char* a, int to, const char* b, unsigned flags) {
  note("rename", a, b);
  return REAL(renameat2)(from, a, to, b, flags);
}
int link(const char* a, const char* b) {
  note("link", a, b);
  return getenv("TEST_NO_LINKS") != NULL ? (errno = EPERM, -1) : REAL(link)(a, b);
}
int unlink(const char* a) {
  note("unlink", a, "");
  return REAL(unlink)(a);
}
int fsync(int file) {
  char path[4096];
  name_of(file, path, sizeof path);
  note("fsync", path, "");
  return REAL(fsync)(file);
}
int close(int file) {
  const int fails = fails_to_close(file);
  const int done = REAL(close)(file);
  return fails ? (errno = EDQUOT, -1) : done;
}
ssize_t write(int file, const void* text, size_t size) {
  static int rows = 0;
  char path[4096];
  name_of(file, path, sizeof path);
  const ssize_t done = REAL(write)(file, text, size);
  if (strstr(path, "history.csv") != NULL && ++rows == number("TEST_TERM_AT_ROW")) raise(SIGTERM);
  if (!allocator_is_locked && rows > 0 && rows == number("TEST_CRASH_AT_ROW")) {
    allocator_is_locked = 1;
    raise(SIGSEGV);
  }
  return done;
}
"""


def library(folder):
    """Compiles it; what goes into the environment of a run."""
    source, path = folder / "interposed.c", folder / "interposed.so"
    source.write_text(SOURCE)
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", source, "-o", path, "-ldl"], check=True)
    source.unlink()
    preloaded = ":".join(filter(None, [str(path), ENVIRONMENT.get("LD_PRELOAD")]))
    return {"LD_PRELOAD": preloaded}
