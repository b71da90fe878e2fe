/* Simulation of a disk that keeps synced data and an arbitrary part of the other data (LD_PRELOAD).
 *
 * When the program syncs a file of the folder SINEW_DISK, its bytes are copied to the folder SINEW_DISK_KEEPS. After the
 * program was killed, the files there contain the data that is guaranteed to be on the disk. scripts/watch/prove mixes them with what was
 * written since, page by page. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void keep(int file) {
  const char *disk = getenv("SINEW_DISK"), *keeps = getenv("SINEW_DISK_KEEPS");
  char link[64], path[PATH_MAX], to[PATH_MAX], beside[PATH_MAX + 8], buffer[1 << 16];
  if (!disk || !keeps) return;
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return;
  path[length] = 0;
  if (strncmp(path, disk, strlen(disk)) != 0) return;
  struct stat about;
  if (fstat(file, &about) != 0 || !S_ISREG(about.st_mode)) return;
  if (snprintf(to, sizeof to, "%s/%s", keeps, strrchr(path, '/') + 1) >= (int)sizeof to) return;
  snprintf(beside, sizeof beside, "%s.new", to);
  int out = open(beside, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (out < 0) abort();
  off_t at = 0;
  ssize_t got;
  while ((got = pread(file, buffer, sizeof buffer, at)) > 0) {
    if (write(out, buffer, (size_t)got) != got) abort();
    at += got;
  }
  close(out);
  if (rename(beside, to) != 0) abort();
}

/* Copies synced data before the call returns to the program. */
int fsync(int file) {
  int (*real)(int) = (int (*)(int))dlsym(RTLD_NEXT, "fsync");
  int done = real(file);
  if (done == 0) keep(file);
  return done;
}

int fdatasync(int file) {
  int (*real)(int) = (int (*)(int))dlsym(RTLD_NEXT, "fdatasync");
  int done = real(file);
  if (done == 0) keep(file);
  return done;
}
