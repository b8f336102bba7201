#include <lambent/error.h>

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Cuts a UTF-8 sequence that the end of the buffer has split. */
static void drop_split_character(char *message)
{
    const size_t length = strlen(message);
    size_t start = length;
    while (start > 0 && ((unsigned char)message[start - 1] & 0xc0u) == 0x80u) {
        --start;
    }
    const unsigned char lead = start > 0 ? (unsigned char)message[start - 1] : 0;
    const size_t wanted = lead >= 0xf0u ? 4 : lead >= 0xe0u ? 3 : lead >= 0xc0u ? 2 : 1;
    if (start > 0 && length - (start - 1) < wanted) {
        message[start - 1] = '\0';
    }
}

lmb_result lmb_error_set(lmb_error *error, lmb_result result, const char *format, ...)
{
    if (!error) {
        return result;
    }
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    if (length < 0) {
        snprintf(error->message, sizeof error->message, "%s", lmb_result_text(result));
    } else if ((size_t)length >= sizeof error->message) {
        drop_split_character(error->message);
    }
    for (char *c = error->message; *c; ++c) {
        if ((unsigned char)*c < 0x20 || *c == 0x7f) {
            *c = '?';
        }
    }
    return result;
}
