// The one place where stb's functions are compiled; a file of its own, for its warnings are not ours.
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
