// C++ because what was thrown can be asked for in C++ only.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include "interrupt.h"

namespace {

[[noreturn]] void on_terminate()
{
    const std::exception_ptr thrown = std::current_exception();
    try {
        if (thrown) {
            std::rethrow_exception(thrown);
        }
        interrupt_fail("a library failed without saying why");
    } catch (const std::bad_alloc &) {
        interrupt_fail("out of memory");
    } catch (const std::exception &exception) {
        char line[256];
        std::snprintf(line, sizeof line, "a library failed, most likely out of memory: %s", exception.what());
        interrupt_fail(line);
    } catch (...) {
        interrupt_fail("a library failed without saying why");
    }
    std::abort();
}

} // namespace

void interrupt_catch_terminate(void)
{
    std::set_terminate(on_terminate);
}
