// doctest, and the message of an exception.
#pragma once

#include <doctest/doctest.h>

#include <exception>
#include <string>
#include <utility>

// The message of the exception of this type that the call throws, or what happened instead.
template <class Exception, class Call>
std::string thrown(Call&& call) {
    try {
        std::forward<Call>(call)();
    } catch (const Exception& exception) {
        return exception.what();
    } catch (const std::exception& exception) {
        return std::string("another exception: ") + exception.what();
    }
    return "no exception";
}
