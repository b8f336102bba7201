#ifndef LMB_HEX_DIGIT_H
#define LMB_HEX_DIGIT_H

/* What a hexadecimal digit of either case stands for, or -1. */
static inline int lmb_hex_digit(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

#endif
