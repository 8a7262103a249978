"""Plants for tests: functions of a module, so that workers and TOML files can name them."""


def thrown(speed):
    """Throw a ball: its height, every tenth of a second for two seconds."""
    for k in range(21):
        yield k / 10, {"height": speed * k / 10 - 4.9 * (k / 10) ** 2}


def valley(x, y):
    """Return a recording whose robustness for `always(z >= 0)` is least at x = 0.3, y = 0.7: -0.05."""
    return {"time": [0.0, 1.0], "z": [5.0, (x - 0.3) ** 2 + (y - 0.7) ** 2 - 0.05]}


def follower(command):
    """Follow a signal with a lag of first order, 100 steps a second for ten seconds."""
    position = 0.0
    for k in range(1001):
        time = k / 100
        position += (command(time) - position) / 50
        yield time, {"command": command(time), "position": position}
