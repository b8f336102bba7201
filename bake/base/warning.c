#include <lambent/warning.h>

#include <stdarg.h>
#include <stdio.h>

#include <lambent/error.h>

void lmb_warn(const lmb_warnings *warnings, const char *format, ...)
{
    if (!warnings || !warnings->warn) {
        return;
    }
    char text[LMB_ERROR_MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    lmb_error line; /* an error's line has no split or control character, and so has this */
    lmb_error_set(&line, LMB_OK, "%s", text);
    warnings->warn(warnings->context, line.message);
}
