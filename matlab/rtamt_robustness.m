function robustness = rtamt_robustness(specification, variables, period, samples)
%RTAMT_ROBUSTNESS Robustness of a requirement at every sample of a recording.
%
%   RHO = RTAMT_ROBUSTNESS(SPECIFICATION, VARIABLES, PERIOD, SAMPLES) takes the
%   three parameters of the block ONLINE_MONITOR and SAMPLES, an array with a row for
%   each sample, PERIOD seconds apart, and a column for each variable. RHO is a
%   column vector: RHO(i) is the robustness at sample i. Windows are truncated at the
%   end of the recording: 'always' uses the remaining samples.
%
%   Example:
%       rtamt_robustness('eventually[0:1](x >= 3)', 'x', 1, [1; 5; 2])  % 2; 2; -1
%
%   See also ONLINE_MONITOR.

    names = variable_names(variables);
    if ~isnumeric(samples) || ~isreal(samples) || size(samples, 2) ~= numel(names)
        error('rtamt:width', ['The samples must be an array of real numbers with %d ' ...
              'columns, one for each variable: %s.'], numel(names), strjoin(names, ', '));
    end
    [monitor, order] = open_monitor(specification, names, period);
    close_it = onCleanup(@() rtamt_gateway('destroy', monitor));
    samples = double(samples(:, order));
    about = rtamt_gateway('describe', monitor);
    robustness = zeros(size(samples, 1), 1);
    for i = 1:size(samples, 1)
        known = rtamt_gateway('step', monitor, samples(i, :));
        if i > about.lag
            robustness(i - about.lag) = known(1);
        end
    end
    [first, rest] = rtamt_gateway('finish', monitor);
    robustness(first + (1:numel(rest))) = rest;
end
