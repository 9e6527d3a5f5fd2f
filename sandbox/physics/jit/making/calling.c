/* How Python calls the entries of a library: one C function for all of them, which Python sees as a builtin function.

   An entry takes the address of its argument block: the words of its arguments one after another, as bundles.py lays
   them out; its result is the first word afterwards. This function fills such a block from Python's objects. It knows
   the layout of a numpy array, which numpy never changes; for the rest it calls Python by addresses that `connect` is
   told, so that a library needs no header of Python, fits every version, and has no undefined symbols. */

typedef long long Word;
typedef struct Object { Word references; void *type; } Object;
typedef struct Array {
    Object head;
    void *data;
    int dimensions;
    Word *shape, *strides;
    Object *base, *dtype;
    int flags;
} Array;

/* What an argument is to be. Of an array: its dtype, dimensions and bytes of an item; of a tuple: how many items. */
enum { INTEGER, FLOAT, FLAG, ARRAY, TUPLE };
typedef struct Kind { Word form; Object *dtype; Word count, item_size; } Kind;
enum { NOTHING, GIVES_INTEGER, GIVES_FLOAT, GIVES_FLAG };
typedef struct Entry {
    int (*run)(Word *block);
    const char *name;
    Word gives, arguments;
    /* Called in its place with arguments of other types; 0: that is an error. */
    Object *otherwise;
    Kind kinds[];
} Entry;

/* In the order of library.py. */
typedef struct Interpreter {
    void *array_type;
    void *none;
    Object *type_error, *runtime_error;
    double (*as_float)(Object *);
    Word (*as_integer)(Object *);
    int (*as_flag)(Object *);
    void *(*as_address)(Object *);
    Word (*tuple_size)(Object *);
    Object *(*tuple_item)(Object *, Word);
    int (*is_equal)(Object *, Object *, int);
    Object *(*occurred)(void);
    Object *(*format)(Object *, const char *, ...);
    Object *(*call)(Object *, Object *const *, Word, Object *);
    Object *(*from_float)(double);
    Object *(*from_integer)(Word);
    Object *(*from_flag)(long);
    void (*keep)(Object *);
    void (*end)(const char *);
    unsigned long (*start_thread)(void (*)(void *), void *);
    void *(*new_lock)(void);
    int (*acquire)(void *, int);
    void (*release)(void *);
} Interpreter;

#if defined(_WIN32)
#define SHARED __declspec(dllexport)
#else
#define SHARED __attribute__((visibility("default")))
#endif
/* At most so many words has a block; library.py refuses an entry with more. */
#define BLOCK 448
enum { EQUAL = 2, CONTIGUOUS = 0x1, WRITEABLE = 0x400 };

static Interpreter python;

/* Whether the processor, and the system, run what is compiled for level v3: AVX2 and what came with it. */
SHARED int runs_wide(void) {
#if defined(__x86_64__)
    unsigned a, b, c, d, low, high;
    __asm__("cpuid" : "=a"(a), "=b"(b), "=c"(c), "=d"(d) : "a"(0), "c"(0));
    if (a < 7) return 0;
    __asm__("cpuid" : "=a"(a), "=b"(b), "=c"(c), "=d"(d) : "a"(1), "c"(0));
    /* MOVBE, OSXSAVE, AVX, F16C; and SSE4.2, POPCNT of level v2. */
    const unsigned wanted = 1u << 22 | 1u << 27 | 1u << 28 | 1u << 29 | 1u << 20 | 1u << 23;
    if ((c & wanted) != wanted) return 0;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    if ((low & 6) != 6) return 0;
    __asm__("cpuid" : "=a"(a), "=b"(b), "=c"(c), "=d"(d) : "a"(7), "c"(0));
    /* BMI1, AVX2, BMI2. */
    if ((b & (1u << 3 | 1u << 5 | 1u << 8)) != (1u << 3 | 1u << 5 | 1u << 8)) return 0;
    __asm__("cpuid" : "=a"(a), "=b"(b), "=c"(c), "=d"(d) : "a"(0x80000001u), "c"(0));
    /* LZCNT. */
    return (c & 1u << 5) != 0;
#else
    return 0;
#endif
}

SHARED void connect(const Interpreter *interpreter) { python = *interpreter; }

#if defined(KERNELS_CHECKED)
static char *digits(char *end, Word number) {
    unsigned long long rest = number < 0 ? 0ull - number : number;
    do *--end = '0' + rest % 10; while (rest /= 10);
    if (number < 0) *--end = '-';
    return end;
}

static char *before(char *end, const char *text) {
    const char *last = text;
    while (*last) last++;
    while (last > text) *--end = *--last;
    return end;
}

/* End the process, and say where in the C++ of kernels. */
void end_out_of_range(const char *file, int line, Word index, Word length) {
    char text[256] = "", *at = text + sizeof text - 1;
    at = before(digits(before(digits(at, length), " of "), index), ": index ");
    python.end(before(before(digits(at, line), ":"), file));
}
#endif

/* Threads that share the items of a loop with the one that calls it. They call nothing of Python but its locks, and
   sleep between loops; which thread takes an item is chance, so items depend on nothing that another writes. */
#define MOST_THREADS 8
/* Looks for the next loop before a thread sleeps: some microseconds. */
#define LOOKS 200
enum { OPEN = 1 << 16 };
static struct {
    Word wanted, started; /* threads beside the caller */
    Word taken;           /* whether a loop is shared: one within it, or of another caller, is a plain one */
    Word state;           /* OPEN while there may be items left, and how many threads are at work */
    Word items, next;
    void (*run)(const void *, Word);
    const void *what;
    Word asked[MOST_THREADS];
    void *go[MOST_THREADS];
} pool;

/* Multiplications of a loop that is shared. */
Word worth_sharing = (Word)(~0ull >> 1);

static void pause_a_little(void) {
#if defined(__x86_64__)
    __asm__ volatile("pause");
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

static void run_items(void) {
    Word item;
    while ((item = __atomic_fetch_add(&pool.next, 1, __ATOMIC_ACQ_REL)) < pool.items) pool.run(pool.what, item);
}

static void work_on(void *place) {
    const Word k = (Word)place;
    for (;;) {
        int looks = 0;
        while (looks < LOOKS && !python.acquire(pool.go[k], 0)) {
            looks++;
            pause_a_little();
        }
        if (looks == LOOKS) python.acquire(pool.go[k], 1);
        __atomic_store_n(&pool.asked[k], 0, __ATOMIC_SEQ_CST);
        Word seen = __atomic_load_n(&pool.state, __ATOMIC_SEQ_CST);
        while (seen & OPEN &&
               !__atomic_compare_exchange_n(&pool.state, &seen, seen + 1, 0, __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST)) {}
        if (!(seen & OPEN)) continue;
        run_items();
        __atomic_sub_fetch(&pool.state, 1, __ATOMIC_SEQ_CST);
    }
}

/* How many threads share loops of so many multiplications, the caller among them; they start with the first loop. */
SHARED void use_threads(Word count, Word worth) {
    pool.wanted = count < 1 ? 0 : count > MOST_THREADS ? MOST_THREADS - 1 : count - 1;
    worth_sharing = pool.wanted ? worth : (Word)(~0ull >> 1);
}

/* Threads beside callers that were started. */
SHARED Word threads_started(void) { return pool.started; }

/* In a process that was forked: it has none of the threads of the other. */
SHARED void forget_threads(void) {
    pool.started = pool.taken = pool.state = 0;
}

static void start_threads(void) {
    while (pool.started < pool.wanted) {
        const Word k = pool.started;
        void *lock = python.new_lock();
        if (!lock || !python.acquire(lock, 0)) break;
        pool.go[k] = lock;
        pool.asked[k] = 0;
        if (python.start_thread(work_on, (void *)k) == (unsigned long)-1) break;
        pool.started = k + 1;
    }
    if (pool.started < pool.wanted) pool.wanted = pool.started;
}

void share(Word items, void (*run)(const void *what, Word item), const void *what) {
    if (!pool.wanted || __atomic_exchange_n(&pool.taken, 1, __ATOMIC_ACQ_REL)) {
        for (Word item = 0; item < items; item++) run(what, item);
        return;
    }
    if (pool.started < pool.wanted) start_threads();
    pool.run = run;
    pool.what = what;
    pool.items = items;
    __atomic_store_n(&pool.next, 0, __ATOMIC_SEQ_CST);
    __atomic_store_n(&pool.state, OPEN, __ATOMIC_SEQ_CST);
    for (Word k = 0; k < pool.wanted && k + 1 < items; k++)
        if (!__atomic_exchange_n(&pool.asked[k], 1, __ATOMIC_SEQ_CST)) python.release(pool.go[k]);
    run_items();
    __atomic_fetch_and(&pool.state, ~(Word)OPEN, __ATOMIC_SEQ_CST);
    while (__atomic_load_n(&pool.state, __ATOMIC_SEQ_CST)) pause_a_little();
    __atomic_store_n(&pool.taken, 0, __ATOMIC_SEQ_CST);
}

#if defined(_WIN32)
/* Called when the library is loaded: nothing is to be done. */
int DllMainCRTStartup(void *library, unsigned reason, void *reserved) { return 1; }
#endif

/* The words of an array; where they end, 0 if it is another than wanted. */
static Word *array_words(Object *object, const Kind *kind, Word *word) {
    const Array *array = (const Array *)object;
    if (object->type != python.array_type || array->dimensions != kind->count) return 0;
    if (!(array->flags & CONTIGUOUS) || !(array->flags & WRITEABLE)) return 0;
    if (array->dtype != kind->dtype && python.is_equal(array->dtype, kind->dtype, EQUAL) != 1) return 0;
    Word items = 1;
    for (Word k = 0; k < kind->count; k++) items *= array->shape[k];
    *word++ = 0;
    *word++ = 0;
    *word++ = items;
    *word++ = kind->item_size;
    *word++ = (Word)array->data;
    for (Word k = 0; k < kind->count; k++) *word++ = array->shape[k];
    for (Word k = 0; k < kind->count; k++) *word++ = array->strides[k];
    return word;
}

/* The words of an argument, and the kind of the next one; where they end, 0 if it is another than wanted. */
static Word *argument_words(Object *object, const Kind **next, Word *word) {
    const Kind *kind = (*next)++;
    if (kind->form == ARRAY) return array_words(object, kind, word);
    if (kind->form == TUPLE) {
        if (python.tuple_size(object) != kind->count) return 0;
        for (Word k = 0; k < kind->count; k++) {
            word = argument_words(python.tuple_item(object, k), next, word);
            if (!word) return 0;
        }
        return word;
    }
    if (kind->form == FLOAT) {
        double value = python.as_float(object);
        if (value == -1.0 && python.occurred()) return 0;
        *(double *)word = value;
    } else if (kind->form == INTEGER) {
        *word = python.as_integer(object);
        if (*word == -1 && python.occurred()) return 0;
    } else {
        int value = python.as_flag(object);
        if (value < 0) return 0;
        *word = value;
    }
    return word + 1;
}

static Object *result_of(const Entry *entry, const Word *block) {
    if (entry->gives == GIVES_FLOAT) return python.from_float(*(const double *)block);
    if (entry->gives == GIVES_INTEGER) return python.from_integer(*block);
    if (entry->gives == GIVES_FLAG) return python.from_flag(*block & 1);
    python.keep(python.none);
    return python.none;
}

/* A builtin function of Python, METH_FASTCALL; self: the address of an Entry, as an int. */
SHARED Object *call(Object *self, Object *const *arguments, Word count) {
    const Entry *entry = python.as_address(self);
    Word block[BLOCK];
    Word *word = block;
    const Kind *next = entry->kinds;
    if (count != entry->arguments)
        return python.format(
            python.type_error, "%s takes %d arguments, not %d", entry->name, (int)entry->arguments, (int)count);
    for (Word k = 0; k < count; k++) {
        word = argument_words(arguments[k], &next, word);
        if (!word) {
            if (python.occurred()) return 0;
            if (entry->otherwise) return python.call(entry->otherwise, arguments, count, 0);
            return python.format(
                python.type_error, "argument %d of %s has not the type that it was compiled for", (int)k + 1,
                entry->name);
        }
    }
    int status = entry->run(block);
    if (status) return python.format(python.runtime_error, "%s failed with code %d", entry->name, status);
    return result_of(entry, block);
}
