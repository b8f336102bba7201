#include <lambent/version.h>

#define TEXT_OF(number) #number
#define TEXT_OF_VALUE(macro) TEXT_OF(macro)

int lmb_version(void)
{
    return LMB_VERSION;
}

const char *lmb_version_text(void)
{
    return TEXT_OF_VALUE(LMB_VERSION_MAJOR) "." TEXT_OF_VALUE(LMB_VERSION_MINOR) "." TEXT_OF_VALUE(LMB_VERSION_PATCH);
}
