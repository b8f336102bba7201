#include <lambent/base64.h>

#include <stdint.h>
#include <string.h>

static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

static int digit_value(char c)
{
    if (c >= 'A' && c <= 'Z') {
        return c - 'A';
    }
    if (c >= 'a' && c <= 'z') {
        return c - 'a' + 26;
    }
    if (c >= '0' && c <= '9') {
        return c - '0' + 52;
    }
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

size_t lmb_base64_length(size_t size)
{
    return (size + 2) / 3 * 4;
}

void lmb_base64_encode(const void *data, size_t size, char *text)
{
    const unsigned char *const bytes = data;
    for (size_t i = 0; i < size; i += 3) {
        const size_t given = size - i < 3 ? size - i : 3;
        const uint32_t bits = (uint32_t)bytes[i] << 16 | (given > 1 ? (uint32_t)bytes[i + 1] << 8 : 0u) |
                              (given > 2 ? (uint32_t)bytes[i + 2] : 0u);
        *text++ = digits[bits >> 18];
        *text++ = digits[bits >> 12 & 63];
        *text++ = given > 1 ? digits[bits >> 6 & 63] : '=';
        *text++ = given > 2 ? digits[bits & 63] : '=';
    }
    *text = '\0';
}

bool lmb_base64_decode(const char *text, unsigned char *bytes, size_t *size)
{
    uint32_t bits = 0;
    unsigned bit_count = 0;
    size_t used = 0;
    for (; *text && *text != '='; ++text) {
        const int digit = digit_value(*text);
        if (digit < 0) {
            return false;
        }
        bits = (bits << 6 | (uint32_t)digit) & 0xffffffu;
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            bytes[used++] = (unsigned char)(bits >> bit_count);
        }
    }
    *size = used;
    return strspn(text, "=") == strlen(text) && strlen(text) <= 2;
}
