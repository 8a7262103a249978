function names = variable_names(given)
% Return variable names as a cell row, from {'a', 'b'} or 'a, b'.
    if isa(given, 'string')
        given = cellstr(given);
    end
    if ischar(given)
        given = regexp(given, '[^\s,]+', 'match');
    end
    if ~iscellstr(given) || isempty(given)
        error('rtamt:variables', '%s', ['The names of the variables must be text, such ' ...
              'as ''req, gnt'', or a cell array of texts, such as {''req'', ''gnt''}.']);
    end
    names = strtrim(given(:)');
    for i = 2:numel(names)
        if any(strcmp(names{i}, names(1:i - 1)))
            error('rtamt:variables', ...
                  'The variable ''%s'' is named twice: each element of the input has its own.', ...
                  names{i});
        end
    end
end
