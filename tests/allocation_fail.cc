// `new` of the C++ files that are linked statically, by its name in the Itanium ABI: void *operator new(unsigned long).
#include "allocation_fail.h"

#include <cstddef>
#include <new>

extern "C" {
void *__real__Znwm(std::size_t size);
void *__wrap__Znwm(std::size_t size);

void *__wrap__Znwm(std::size_t size)
{
    if (allocation_new_fails_now()) {
        throw std::bad_alloc();
    }
    return __real__Znwm(size);
}
}
