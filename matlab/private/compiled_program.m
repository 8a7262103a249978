function bytes = compiled_program(specification, period)
% Return the program of a specification as uint8: read from a file (.rtamt), or
% compiled by 'rtamt compile' from a file or a text.
    if isa(specification, 'string')
        specification = char(specification);
    end
    if ~ischar(specification) || size(specification, 1) ~= 1 || isempty(strtrim(specification))
        error('rtamt:specification', '%s', ['The specification must be text, or the name ' ...
              'of a file (.stl, or .rtamt as ''rtamt compile'' writes it).']);
    end
    named = ends_with(specification, '.stl') || ends_with(specification, '.rtamt');
    if named && ~isfile(specification)
        error('rtamt:specification', 'There is no file ''%s'' (the current folder is %s).', ...
              specification, pwd);
    elseif ends_with(specification, '.rtamt')
        bytes = read_bytes(specification);
    elseif isfile(specification)
        bytes = compile_file(specification, period, [specification ': ']);
    else
        bytes = compile_text(specification, period);
    end
end

function bytes = compile_text(text, period)
    name = [tempname '.stl'];
    remove = onCleanup(@() remove_file(name));
    file = open_file(name, 'w');
    fwrite(file, unicode2native(text, 'UTF-8'), 'uint8');
    fclose(file);
    bytes = compile_file(name, period, '');
end

function bytes = compile_file(name, period, shown)
% `shown`: how messages name the file.
    python = installed_python();
    program = [tempname '.rtamt'];
    remove = onCleanup(@() remove_file(program));
    order = sprintf('-m rtamt compile %s -o %s --period %s', ...
                    quoted(name), quoted(program), decimal(period));
    [status, said] = run_python(python, order);
    own = 'rtamt: '; % what our own sentences begin with
    if status ~= 0 && strncmp(said, own, numel(own))
        said = strrep(strtrim(said(numel(own) + 1:end)), [name ': '], shown);
        error('rtamt:specification', '%s', said);
    elseif status ~= 0
        error('rtamt:notInstalled', ['The specification cannot be compiled, for rtamt does ' ...
              'not run in %s: run install_rtamt with a Python that has it, or give a ' ...
              'program that ''rtamt compile'' has written elsewhere (.rtamt). It said: %s'], ...
              python, strtrim(said));
    end
    bytes = read_bytes(program);
end

function python = installed_python()
% What install_rtamt wrote down.
    name = fullfile(fileparts(mfilename('fullpath')), 'python.txt');
    if ~isfile(name)
        error('rtamt:notInstalled', '%s', ['To compile a specification rtamt must be ' ...
              'installed: run install_rtamt, or give a program that ''rtamt compile'' has ' ...
              'written elsewhere (.rtamt).']);
    end
    python = strtrim(fileread(name));
end

function text = decimal(seconds)
% The shortest decimal that is this number: 0.1 is a tenth of a second.
    text = sprintf('%.15g', seconds);
    if str2double(text) ~= seconds
        text = sprintf('%.17g', seconds);
    end
end

function bytes = read_bytes(name)
    file = open_file(name, 'r');
    bytes = fread(file, Inf, '*uint8')';
    fclose(file);
end

function file = open_file(name, mode)
    [file, reason] = fopen(name, mode);
    if file < 0
        error('rtamt:specification', 'The file ''%s'' cannot be opened: %s.', name, reason);
    end
end

function remove_file(name)
    if isfile(name)
        delete(name);
    end
end

function yes = ends_with(text, ending)
    yes = numel(text) >= numel(ending) && strcmp(text(end - numel(ending) + 1:end), ending);
end
