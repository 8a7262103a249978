function [monitor, order] = open_monitor(specification, variables, period)
% A monitor of a specification, and where among `variables` each input of it is.
    names = variable_names(variables);
    require_gateway();
    monitor = rtamt_gateway('create', compiled_program(specification, period));
    try
        about = rtamt_gateway('describe', monitor);
        check_period(about.seconds, period);
        order = places(about.inputs, names);
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
              unknown{1}, listed(inputs));
    end
end

function text = listed(inputs)
    text = 'no variable';
    if ~isempty(inputs)
        text = strjoin(inputs, ', ');
    end
end
