// What the kernels below stand on: arrays as bundles lay them out, and Python's arithmetic of integers.
//
// No header of a system is needed, and nothing of its libraries.

typedef signed char int8_t;
typedef int int32_t;
typedef unsigned uint32_t;
typedef long long int64_t;
typedef unsigned long long uint64_t;

#define INFINITY __builtin_inf()
#define NAN __builtin_nan("")

#if defined(__wasm__)
// An address has 32 bits there, and lies in 8 bytes, so that bundles look as everywhere.
template <class T> struct Address {
    uint64_t word;
    Address() = default;
    Address(T *place) : word((unsigned long)place) {}
    operator T *() const { return (T *)(unsigned long)word; }
};
#else
template <class T> using Address = T *;
#endif

#if defined(KERNELS_CHECKED)
extern "C" void end_out_of_range(const char *file, int line, int64_t index, int64_t length);
#define KERNELS_PLACE , const char *file = __builtin_FILE(), int line = __builtin_LINE()
#define KERNELS_CHECK(index, axis) if (index < 0 || index >= shape[axis]) end_out_of_range(file, line, index, shape[axis])
#else
#define KERNELS_PLACE
#define KERNELS_CHECK(index, axis)
#endif

template <class T, int dimensions> struct Array {
    int64_t unused[2], items, item_size;
    Address<T> data;
    int64_t shape[dimensions], strides[dimensions];

    T &operator()(int64_t i KERNELS_PLACE) const requires(dimensions == 1) {
        KERNELS_CHECK(i, 0);
        return ((T *)data)[i];
    }
    T &operator()(int64_t i, int64_t j KERNELS_PLACE) const requires(dimensions == 2) {
        KERNELS_CHECK(i, 0);
        KERNELS_CHECK(j, 1);
        return ((T *)data)[i * shape[1] + j];
    }
    T &operator()(int64_t i, int64_t j, int64_t k KERNELS_PLACE) const requires(dimensions == 3) {
        KERNELS_CHECK(i, 0);
        KERNELS_CHECK(j, 1);
        KERNELS_CHECK(k, 2);
        return ((T *)data)[(i * shape[1] + j) * shape[2] + k];
    }
};

// What a bundle is to Python: an array of one record, which lies at its data.
template <class T> struct Bundle : Array<T, 1> {};
template <class T> const T &unpack(const Bundle<T> &bundle) { return *(const T *)bundle.data; }
template <class T> void set_field(const T &place, const T &value) { const_cast<T &>(place) = value; }

// An array in the memory of another, from an item on, of so many rows.
template <class A, class... Sizes> static A lying(const Array<int64_t, 1> &memory, int64_t first, Sizes... sizes) {
    typedef __remove_reference_t(decltype(*(A{}.data + 0))) Item;
    A made{};
    made.data = (Item *)((int64_t *)memory.data + first);
    const int64_t shape[] = {sizes...};
    const int dimensions = sizeof...(sizes);
    made.item_size = sizeof(Item);
    made.items = 1;
    int64_t stride = sizeof(Item);
    for (int k = dimensions - 1; k >= 0; k--) {
        made.shape[k] = shape[k];
        made.strides[k] = stride;
        made.items *= shape[k];
        stride *= shape[k];
    }
    return made;
}

// The rows first..last of an array, those of them that there are.
template <class T, int dimensions> static Array<T, dimensions> cut(Array<T, dimensions> array, int64_t first, int64_t last) {
    int64_t width = 1;
    for (int k = 1; k < dimensions; k++) width *= array.shape[k];
    const int64_t end = last < array.shape[0] ? last : array.shape[0], begin = first < end ? first : end;
    array.data = (T *)array.data + begin * width;
    array.shape[0] = end - begin;
    array.items = array.shape[0] * width;
    return array;
}

// Loops whose items threads may share, where they have so many multiplications.
#if !defined(__wasm__)
extern "C" int64_t worth_sharing;
extern "C" void share(int64_t items, void (*run)(const void *what, int64_t item), const void *what);
#endif
template <class F> static void parallel(int64_t items, int64_t work, const F &body) {
#if !defined(__wasm__)
    if (items > 1 && work >= worth_sharing) {
        share(items, [](const void *what, int64_t item) { (*(const F *)what)(item); }, &body);
        return;
    }
#endif
    for (int64_t item = 0; item < items; item++) body(item);
}

template <class A, class B> struct Tuple2 { A item0; B item1; };
template <class A, class B, class C> struct Tuple3 { A item0; B item1; C item2; };
template <class A, class B, class C, class D> struct Tuple4 { A item0; B item1; C item2; D item3; };
template <class A, class B, class C, class D, class E> struct Tuple5 { A item0; B item1; C item2; D item3; E item4; };
template <class A, class B, class C, class D, class E, class F, class G, class H> struct Tuple8 {
    A item0; B item1; C item2; D item3; E item4; F item5; G item6; H item7;
};

namespace py {

// As Python's min, max and abs: of equal ones the first, and a NaN only where it is the first.
template <class T> static T min(T a, T b) { return b < a ? b : a; }
template <class T> static T max(T a, T b) { return b > a ? b : a; }
static double abs(double a) { return __builtin_fabs(a); }
static int64_t abs(int64_t a) { return a < 0 ? -a : a; }

static double sqrt(double a) { return __builtin_sqrt(a); }
// Processors of the oldest kind have no instruction for these: the same bits as theirs, but for the sign of 0.
static int64_t floor(double a) {
    const int64_t whole = (int64_t)a;
    return (double)whole > a ? whole - 1 : whole;
}
static int64_t ceil(double a) {
    const int64_t whole = (int64_t)a;
    return (double)whole < a ? whole + 1 : whole;
}
static int64_t floordiv(int64_t a, int64_t b) {
    const int64_t quotient = a / b;
    return a % b != 0 && (a < 0) != (b < 0) ? quotient - 1 : quotient;
}
static int64_t mod(int64_t a, int64_t b) {
    const int64_t rest = a % b;
    return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}

}

// Entries: a block of words holds the arguments, one after another, and then the result in its first word.
#if defined(_WIN32)
#define KERNELS_SHARED __declspec(dllexport)
#else
#define KERNELS_SHARED __attribute__((visibility("default")))
#endif
#define KERNELS_ENTRY(name) extern "C" KERNELS_SHARED int name(int64_t *block)
template <class T> static const T &argument(const int64_t *word) { return *(const T *)word; }
static void give(int64_t *block, double result) { __builtin_memcpy(block, &result, sizeof result); }
static void give(int64_t *block, int64_t result) { block[0] = result; }
static void give(int64_t *block, bool result) { block[0] = result; }
