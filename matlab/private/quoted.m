function text = quoted(text)
% One word for the shell.
    if isunix
        text = ['''' strrep(text, '''', '''\''''') ''''];
    else
        text = ['"' text '"'];
    end
end
