/* machine LIBRARY IMAGE BASE END SYMBOL...: make the calls of an image, as elsewhere.py wrote it, and compare memory and
   results: web.mjs for libraries. Addresses in the image are those of memory here. */
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { PATCH, CALL, CHECK, ROOM = 1 << 20, SHOWN = 5 };
typedef int (*Entry)(void *block);
static long checks, differing;

static void check(const char *what, const char *name, int is_equal) {
    checks++;
    if (is_equal) return;
    if (++differing <= SHOWN) printf("%s %s differs\n", what, name);
}

static void stop(const char *why) {
    fprintf(stderr, "%s\n", why);
    exit(2);
}

int main(int count, char **given) {
    if (count < 6) stop("machine LIBRARY IMAGE BASE END SYMBOL...");
    void *library = dlopen(given[1], RTLD_NOW);
    if (!library) stop(dlerror());
    FILE *image = fopen(given[2], "rb");
    if (!image) stop("the image cannot be read");
    uintptr_t base = strtoull(given[3], 0, 10), end = strtoull(given[4], 0, 10);
    char *block = mmap((void *)(base - ROOM), end - base + ROOM, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
    if (block != (char *)(base - ROOM)) stop("there is no memory at the base of the image");
    const char *last = "";
    for (uint32_t head[3]; fread(head, sizeof head, 1, image) == 1;) {
        char *content = malloc(head[2] + 1);
        if (fread(content, 1, head[2], image) != head[2]) stop("the image is cut off");
        if (head[0] == PATCH) {
            memcpy((void *)(uintptr_t)head[1], content, head[2]);
        } else if (head[0] == CALL) {
            last = given[5 + head[1]];
            Entry entry = (Entry)dlsym(library, last);
            if (!entry) stop(dlerror());
            uint32_t gives;
            memcpy(&gives, content, sizeof gives);
            memcpy(block, content + 12, head[2] - 12);
            check("the status of", last, entry(block) == 0);
            check("the result of", last, !memcmp(block, content + 4, gives == 0 ? 0 : gives == 3 ? 1 : 8));
        } else {
            check("memory after", last, !memcmp((void *)(uintptr_t)head[1], content, head[2]));
        }
        free(content);
    }
    printf("%ld checks, %ld differ\n", checks, differing);
    return 0;
}
