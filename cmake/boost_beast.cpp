// What Beast does not leave to templates (BOOST_BEAST_SEPARATE_COMPILATION).
#include <boost/beast/src.hpp>
