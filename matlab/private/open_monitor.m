function [monitor, order] = open_monitor(specification, variables, period)
% Create a monitor of a specification, and map its inputs to `variables`. The
% specification can be a cell array, followed by names and values of constants.
    names = variable_names(variables);
    require_gateway();
    constants = {};
    if iscell(specification) && ~isempty(specification)
        constants = specification(2:end);
        specification = specification{1};
    end
    monitor = rtamt_gateway('create', compiled_program(specification, period));
    try
        about = rtamt_gateway('describe', monitor);
        check_period(about.seconds, period);
        order = places(about.inputs, names);
        set_constants(monitor, about.constants, constants);
    catch failure
        rtamt_gateway('destroy', monitor);
        rethrow(failure);
    end
end

function require_gateway()
    folder = fileparts(mfilename('fullpath'));
    if ~isfile(fullfile(folder, ['rtamt_gateway.' mexext]))
        error('rtamt:notInstalled', '%s', ['The gateway to rtamt is not built: run ' ...
              'install_rtamt in the folder above ' folder '.']);
    end
end

function check_period(seconds, period)
% A program may have been compiled for another period.
    if abs(seconds - period) > 1e-9 * period
        error('rtamt:period', ['The program was compiled for a period of %.12g s, but ' ...
              'samples come every %.12g s: compile it with ''--period %.12g''.'], ...
              seconds, period, period);
    end
end

function order = places(inputs, names)
% Every variable must be there, and there must be no other one.
    [found, order] = ismember(inputs, names);
    if ~all(found)
        error('rtamt:variables', ['The specification reads ''%s'', which is not among ' ...
              'the variables given: %s.'], ...
              inputs{find(~found, 1)}, strjoin(names, ', '));
    end
    unknown = setdiff(names, inputs);
    if ~isempty(unknown)
        error('rtamt:variables', ['The specification does not read ''%s'': take it out of ' ...
              'the variables, and its signal out of the input. It reads %s.'], ...
              unknown{1}, listed(inputs, 'no variable'));
    end
end

function set_constants(monitor, known, given)
% `given`: names and values in turn.
    names = cellfun(@char_of, given(1:2:end), 'UniformOutput', false);
    values = given(2:2:end);
    if numel(values) ~= numel(names) || ~iscellstr(names)
        error('rtamt:constants', '%s', ['After the specification come names and values of ' ...
              'constants in turn, such as {''response.stl'', ''limit'', 4}.']);
    end
    for i = 1:numel(names)
        name = names{i};
        place = find(strcmp(name, known));
        if isempty(place)
            error('rtamt:constants', ['The specification has no constant ''%s'' that can be ' ...
                  'set: it has %s. A constant that bounds an interval is fixed.'], ...
                  name, listed(known, 'none'));
        elseif any(strcmp(name, names(1:i - 1)))
            error('rtamt:constants', 'The constant ''%s'' is given twice.', name);
        end
        value = values{i};
        if ~isnumeric(value) || ~isreal(value) || ~isscalar(value)
            error('rtamt:constants', 'The constant ''%s'' must be one real number.', name);
        end
        rtamt_gateway('set', monitor, place, double(value));
    end
end

function text = char_of(text)
    if isa(text, 'string')
        text = char(text);
    end
end

function text = listed(names, none)
    text = none;
    if ~isempty(names)
        text = strjoin(names, ', ');
    end
end
